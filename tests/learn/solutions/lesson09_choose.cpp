std::optional<Mine::Choice> Mine::choose(const slam::strategies::Prospects& prospects) {
  std::size_t best = 0;
  double most = -1;
  for (std::size_t i = 0; i < prospects.viewpoints.size(); ++i) {
    const auto& viewpoint = prospects.viewpoints[i];
    const double size = static_cast<double>(prospects.frontiers[viewpoint.frontier].cells.size());
    const double worth = std::sqrt(size) / (1 + viewpoint.cost_m);
    if (worth > most) most = worth, best = i;
  }
  return Choice{best, most, "much to be seen for the way", std::nullopt};
}
