#include "libslam/score/gate.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"
#include "libslam/resources/json_entry.h"
#include "libslam/score/metric_infos.h"
#include "libslam/stats/bootstrap.h"

namespace slam::score {
namespace {

using core::kNaN;
constexpr double kUsualTolerance = 0.1;
constexpr const char* kTranslationMean = "translation_mean_m";
constexpr const char* kRotationMean = "rotation_mean_deg";

double numberAtLeastZero(resources::JsonEntry& entry, const std::string& key) {
  if (!entry.has(key)) return 0;
  const double value = entry.number(key);
  if (!(value >= 0)) entry.fail(key, value, "a number of 0 or more");
  return value;
}

double valueOf(const resources::JsonEntry& entry, const std::string& key, const nlohmann::json& json,
               stats::Better better) {
  if (json.is_null()) return stats::failedValue(better);
  if (!json.is_number()) entry.fail(key, json, "a number, or null for a run that failed");
  return json.get<double>();
}

std::vector<std::uint64_t> readSeeds(resources::JsonEntry& entry, std::size_t count) {
  const auto json = entry.take("seeds");
  const bool is_list = json.is_array() && json.size() == count &&
                       std::all_of(json.begin(), json.end(),
                                   [](const nlohmann::json& seed) { return seed.is_number_unsigned(); });
  auto seeds = is_list ? json.get<std::vector<std::uint64_t>>() : std::vector<std::uint64_t>();
  if (std::set<std::uint64_t>(seeds.begin(), seeds.end()).size() != count)
    entry.fail("seeds", json,
               "a list of different whole numbers, one for each of " + std::to_string(count) +
                   (count == 1 ? " value" : " values"));
  return seeds;
}

GateRow readRow(const nlohmann::json& json, const std::string& where) {
  resources::JsonEntry entry(json, where);
  GateRow row;
  row.baseline.cell = entry.text("cell");
  row.baseline.metric = entry.text("metric");
  const std::string better = entry.text("better");
  if (better != "smaller" && better != "larger") entry.fail("better", better, "smaller or larger");
  row.better = better == "smaller" ? stats::Better::kSmaller : stats::Better::kLarger;
  if (entry.has("values")) {
    const auto values = entry.take("values");
    if (!values.is_array() || values.empty()) entry.fail("values", values, "a list of numbers, one per seed");
    for (const auto& value : values)
      row.baseline.values.push_back(valueOf(entry, "values", value, row.better));
  } else {
    row.baseline.values = {valueOf(entry, "value", entry.take("value"), row.better)};
  }
  if (entry.has("seeds")) row.baseline.seeds = readSeeds(entry, row.baseline.values.size());
  row.relative = numberAtLeastZero(entry, "relative");
  row.absolute = numberAtLeastZero(entry, "absolute");
  entry.expectNothingElse();
  return row;
}

nlohmann::ordered_json jsonOf(const GateRow& row) {
  if (row.baseline.values.empty()) throw core::ContractError("writeGate: a row without values");
  auto values = nlohmann::ordered_json::array();
  for (const double value : row.baseline.values) {
    if (std::isnan(value)) throw core::ContractError("writeGate: a value that is not a number");
    values.push_back(std::isinf(value) ? nlohmann::ordered_json() : nlohmann::ordered_json(value));
  }
  nlohmann::ordered_json json = {
      {"cell", row.baseline.cell},
      {"metric", row.baseline.metric},
      {"better", row.better == stats::Better::kSmaller ? "smaller" : "larger"},
  };
  if (values.size() == 1)
    json["value"] = values.front();
  else
    json["values"] = values;
  if (!row.baseline.seeds.empty()) json["seeds"] = row.baseline.seeds;
  json["relative"] = row.relative;
  json["absolute"] = row.absolute;
  return json;
}

bool isOf(const Score& score, const std::string& cell, const std::string& metric) {
  return score.cell == cell && score.metric == metric;
}

struct Usual {
  stats::Better better;
  int decimals;
};

/// nullopt: nothing to hold a machine-independent figure against.
std::optional<Usual> usualOf(const std::string& metric) {
  if (metric == kTranslationMean || metric == "relation_m") return Usual{stats::Better::kSmaller, 4};
  if (metric == kRotationMean || metric == "relation_deg") return Usual{stats::Better::kSmaller, 3};
  const auto& infos = metricInfos();
  const auto info =
      std::find_if(infos.begin(), infos.end(), [&](const MetricInfo& i) { return i.key == metric; });
  if (info == infos.end() || !info->better || info->depends_on_machine) return std::nullopt;
  return Usual{*info->better, info->decimals};
}

/// How much worse b is than a; negative where it is better. Two failures are equal.
double worsening(double a, double b, stats::Better better) {
  if (a == b) return 0;
  return better == stats::Better::kSmaller ? b - a : a - b;
}

std::size_t failures(const std::vector<double>& values) {
  return static_cast<std::size_t>(
      std::count_if(values.begin(), values.end(), [](double value) { return std::isinf(value); }));
}

/// Leaves of both, where they know their seeds, the values of those that both have, in one order.
void keepCommonSeeds(Score& a, Score& b) {
  if (a.seeds.empty() || b.seeds.empty()) return;
  const Score all_a = a, all_b = b;
  for (Score* score : {&a, &b}) score->values.clear(), score->seeds.clear();
  for (std::size_t i = 0; i < all_a.seeds.size(); ++i) {
    const auto at = std::find(all_b.seeds.begin(), all_b.seeds.end(), all_a.seeds[i]);
    if (at == all_b.seeds.end()) continue;
    a.values.push_back(all_a.values[i]);
    b.values.push_back(all_b.values[static_cast<std::size_t>(at - all_b.seeds.begin())]);
    for (Score* score : {&a, &b}) score->seeds.push_back(*at);
  }
}

/// As shares: the numbers of seeds may differ.
bool failsMoreOften(const std::vector<double>& now, const std::vector<double>& before) {
  return failures(now) * before.size() > failures(before) * now.size();
}

GateVerdict verdictOn(const GateFinding& finding, double alpha) {
  const auto& before = finding.row.baseline.values;
  if (failsMoreOften(finding.values, before)) return GateVerdict::kWorse;
  const double worse_by = worsening(finding.before, finding.now, finding.row.better);
  if (-worse_by > finding.allowed) return GateVerdict::kBetter;
  if (!(worse_by > finding.allowed)) return GateVerdict::kWithin;
  // The smallest p that so many pairs can have.
  const double least_p = core::exp2(1 - static_cast<double>(before.size()));
  const bool may_be_chance = finding.p && least_p <= alpha && *finding.p > alpha;
  return may_be_chance ? GateVerdict::kUnsure : GateVerdict::kWorse;
}

const char* textOf(GateVerdict verdict) {
  switch (verdict) {
    case GateVerdict::kWithin:
      return "ok";
    case GateVerdict::kBetter:
      return "better";
    case GateVerdict::kUnsure:
      return "worse?";
    case GateVerdict::kWorse:
      return "WORSE";
    case GateVerdict::kMissing:
      return "MISSING";
  }
  return "";
}

std::string countsNote(const std::vector<GateFinding>& findings, const std::string& gate_path) {
  const auto count = [&](GateVerdict verdict) {
    return std::to_string(std::count_if(findings.begin(), findings.end(),
                                        [&](const GateFinding& f) { return f.verdict == verdict; }));
  };
  return gate_path + ": of " + std::to_string(findings.size()) + " figures " + count(GateVerdict::kWithin) +
         " within their tolerance, " + count(GateVerdict::kBetter) + " better, " +
         count(GateVerdict::kUnsure) + " worse but perhaps by chance, " + count(GateVerdict::kWorse) +
         " worse, " + count(GateVerdict::kMissing) + " missing.";
}

}  // namespace

Gate readGate(const std::string& path) {
  const auto json = resources::readJsonFile(path);
  if (json.is_discarded()) throw core::InputError(path + ": is not JSON, expected what --write-gate writes");
  resources::JsonEntry entry(json, path);
  Gate gate;
  if (entry.has("alpha")) gate.alpha = entry.number("alpha");
  if (!(gate.alpha > 0 && gate.alpha < 1)) entry.fail("alpha", gate.alpha, "a number between 0 and 1");
  const auto rows = entry.take("rows");
  if (!rows.is_array() || rows.empty()) entry.fail("rows", rows, "a list of at least one row");
  entry.expectNothingElse();
  std::set<std::pair<std::string, std::string>> known;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string where = path + ": row " + std::to_string(i + 1);
    gate.rows.push_back(readRow(rows[i], where));
    const Score& score = gate.rows.back().baseline;
    if (!known.emplace(score.cell, score.metric).second)
      throw core::InputError(where + ": key 'metric': found '" + score.metric + "' of '" + score.cell +
                             "' a second time, expected each once");
  }
  return gate;
}

void writeGate(const Gate& gate, const std::string& path) {
  // A row a line, for people who edit tolerances.
  std::string text = "{\"alpha\": " + nlohmann::json(gate.alpha).dump() + ",\n \"rows\": [";
  const char* comma = "\n  ";
  for (const auto& row : gate.rows) {
    text += comma + jsonOf(row).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    comma = ",\n  ";
  }
  files::writeFileAtomically(path, text + "]}\n");
}

std::vector<Score> scoresOf(const Evaluation& evaluation) {
  std::vector<Score> scores;
  for (const auto& info : metricInfos())
    scores.push_back({evaluation.method, info.key, {info.of(evaluation)}});
  return scores;
}

std::vector<Score> scoresOf(const std::vector<RelationScore>& relation_scores) {
  std::vector<Score> scores;
  for (const auto& score : relation_scores) {
    scores.push_back({score.path, kTranslationMean, {score.error.translation_m.mean}});
    scores.push_back({score.path, kRotationMean, {core::radToDeg(score.error.rotation_rad.mean)}});
  }
  return scores;
}

Gate rowsOfMeasured(const Gate& gate, const std::vector<Score>& scores, const std::string& gate_path) {
  Gate part{gate.alpha, {}};
  std::vector<std::string> measured_cells, known_cells;
  for (const auto& score : scores) measured_cells.push_back(score.cell);
  for (std::size_t i = 0; i < gate.rows.size(); ++i) {
    const Score& baseline = gate.rows[i].baseline;
    known_cells.push_back(baseline.cell);
    std::vector<std::string> metrics;
    for (const auto& score : scores)
      if (score.cell == baseline.cell) metrics.push_back(score.metric);
    if (metrics.empty()) continue;
    if (std::find(metrics.begin(), metrics.end(), baseline.metric) == metrics.end())
      throw core::InputError(gate_path + ": row " + std::to_string(i + 1) + ": key 'metric': found '" +
                             baseline.metric + "', expected a metric that was measured" +
                             core::didYouMean(baseline.metric, metrics));
    part.rows.push_back(gate.rows[i]);
  }
  if (part.rows.empty())
    throw core::InputError(gate_path + ": key 'cell': found none for '" + measured_cells.at(0) +
                           "', expected at least one row" +
                           core::didYouMean(measured_cells.at(0), known_cells));
  return part;
}

Gate updatedGate(const Gate& old, const std::vector<Score>& scores) {
  std::set<std::string> cells;
  for (const auto& score : scores) cells.insert(score.cell);
  Gate gate{old.alpha, {}};
  std::copy_if(old.rows.begin(), old.rows.end(), std::back_inserter(gate.rows),
               [&](const GateRow& row) { return cells.count(row.baseline.cell) == 0; });
  for (const auto& score : scores) {
    const auto usual = usualOf(score.metric);
    const bool is_finite = !score.values.empty() &&
                           std::none_of(score.values.begin(), score.values.end(),
                                        [](double value) { return std::isnan(value); }) &&
                           failures(score.values) < score.values.size();
    if (!usual || !is_finite) continue;
    const auto before = std::find_if(old.rows.begin(), old.rows.end(), [&](const GateRow& row) {
      return isOf(row.baseline, score.cell, score.metric);
    });
    GateRow row{score, usual->better, kUsualTolerance, core::powerOfTen(-usual->decimals)};
    if (before != old.rows.end()) row.relative = before->relative, row.absolute = before->absolute;
    gate.rows.push_back(std::move(row));
  }
  return gate;
}

std::vector<GateFinding> checkGate(const Gate& gate, const std::vector<Score>& scores) {
  std::vector<GateFinding> findings;
  for (const auto& row : gate.rows) {
    GateFinding finding;
    finding.row = row;
    Score& baseline = finding.row.baseline;
    const auto score = std::find_if(scores.begin(), scores.end(), [&](const Score& s) {
      return isOf(s, row.baseline.cell, row.baseline.metric);
    });
    Score measured;
    if (score != scores.end()) {
      measured = *score;
      keepCommonSeeds(baseline, measured);
    }
    if (baseline.values.empty()) baseline = row.baseline;  // no seed in common
    finding.before = stats::median(baseline.values);
    finding.allowed =
        std::max(row.absolute, std::isinf(finding.before) ? 0.0 : row.relative * std::abs(finding.before));
    finding.now = kNaN;
    const bool is_there =
        !measured.values.empty() &&
        std::none_of(measured.values.begin(), measured.values.end(), [](double v) { return std::isnan(v); });
    if (is_there) {
      finding.values = std::move(measured.values);
      finding.now = stats::median(finding.values);
      if (finding.values.size() == baseline.values.size() && finding.values.size() > 1)
        finding.p = stats::wilcoxonSignedRank(finding.values, baseline.values).p;
      finding.verdict = verdictOn(finding, gate.alpha);
    }
    findings.push_back(std::move(finding));
  }
  return findings;
}

bool gateIsShut(const std::vector<GateFinding>& findings) {
  return std::any_of(findings.begin(), findings.end(), [](const GateFinding& finding) {
    return finding.verdict == GateVerdict::kWorse || finding.verdict == GateVerdict::kMissing;
  });
}

table::Table gateTable(const std::vector<GateFinding>& findings, const std::string& gate_path,
                       Detail detail) {
  table::Table table;
  table.caption = "Against the baseline";
  table.columns = {{"cell", "method", 0},
                   {"metric", "metric", 0},
                   {"before", "before", 4},
                   {"now", "now", 4},
                   {"allowed", "may be worse by", 4},
                   {"p", "p", 3, true},
                   {"failed", "failed", 0},
                   {"seeds", "seeds", 0},
                   {"verdict", "verdict", 0}};
  for (const auto& finding : findings) {
    if (detail == Detail::kShort && finding.verdict == GateVerdict::kWithin) continue;
    table.rows.push_back({finding.row.baseline.cell, finding.row.baseline.metric, finding.before, finding.now,
                          finding.allowed, finding.p.value_or(kNaN),
                          static_cast<double>(failures(finding.values)),
                          static_cast<double>(finding.values.size()), textOf(finding.verdict)});
  }
  table.notes.push_back(countsNote(findings, gate_path));
  const bool single = std::any_of(findings.begin(), findings.end(),
                                  [](const GateFinding& finding) { return finding.values.size() == 1; });
  if (single)
    table.notes.emplace_back(
        "One run with one seed against one: what is within a tolerance says nothing of other seeds.");
  return table;
}

}  // namespace slam::score
