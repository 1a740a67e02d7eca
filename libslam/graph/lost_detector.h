#pragma once

namespace slam::graph {

/// Tells from scan after scan whether a robot was kidnapped: Page's cumulative sum of the log likelihood
/// ratio (a repeated sequential probability ratio test) of "is elsewhere since scan s" over "is where the map
/// says".
///
/// Two things speak. The contradicted share: of what the map from before s says of a scan, how much speaks
/// against its place (beams that went through a point that is seen now, and the other way round). And, once,
/// the break at s: how far scan s contradicts the one before it, moved as the robot moved. A robot that
/// drifts contradicts its map, too, but from one scan to the next all fits: without a break kidnapping is the
/// less likely by kUnbroken. A second break, after which the map from before contradicts no more, ends the
/// doubt: what lay between was a glitch.
///
/// How large both shares are where all is well, and how much they vary, is learnt from the scans themselves
/// while they are well; how large they are where the robot is not, from scans put into wrong places on
/// purpose. Where a wrong place contradicts no more than the right one, nothing is ever said. Two
/// readings of a share, of which the one that says more counts: both normal, with the larger of the two
/// variances, as a map that is out of date contradicts by any share; and both as Student's t, each with its
/// own variance, which counts less where it would have spoken for another place while all was well.
///
/// Looks that speak for another place come in streaks where the world is not flat, or people walk about: one
/// that follows another says no more than how seldom that was so while all was well.
///
/// Evidence counts by time and way, not by scan: a scan counts whole when kLook_s or kLook_m have passed
/// since the one before, less else, and never more.
///
/// Sources: Wald, Annals of Mathematical Statistics 16, 1945; Page, Biometrika 41, 1954. The break as the
/// prior of a change, and learning both sides while the robot drives, are ours.
class LostDetector {
 public:
  struct Look {
    double time_s;        ///< times that run back count as none
    double moved_m;       ///< since the look before, by odometry
    double contradicted;  ///< 0..1; NaN counts as nothing
    double telling;       ///< share, 0..1, of the scan of which the map says anything
    double broken;        ///< what the scan before says, 0..1; NaN: nothing
    /// False where the map explains so much of the scan that it cannot speak for kidnapping.
    bool may_be_lost = true;
  };
  void look(const Look& look);
  /// What a scan that was put into a wrong place on purpose says. Anything not finite counts as nothing.
  void learnWrong(double contradicted);

  /// For "is elsewhere", in nats, -kUnbroken or more.
  double evidence() const { return evidence_; }
  bool isLost() const { return evidence_ >= kLost; }
  /// A break, or more that speaks for it than against it.
  bool isInDoubt() const { return evidence_ > kDoubt; }
  /// A doubt has passed: breaks happen here for other reasons (people, uneven ground), and the next one says
  /// less.
  void dismiss();
  /// No scan will tell any more: lost if as much as kToldEnough speaks for it.
  void decide();
  /// The evidence starts anew; what was learnt stays.
  void restart();

  static constexpr double kLook_s = 0.4, kLook_m = 0.5;
  /// One false alarm in exp(kLost) looks (1.2 million) at most, as far as the model holds.
  static constexpr double kLost = 14, kDoubt = -2;
  static constexpr double kUnbroken = 30;
  /// Of doubts that are decided so, one in a thousand is a false alarm at most, as far as the model holds.
  static constexpr double kToldEnough = 7;
  /// A break says so much less for every doubt that was dismissed; of these kForgotten looks leave a third.
  static constexpr double kPerDismissed = 2.5, kForgotten = 300;
  /// One look says at most so much, however large the likelihood ratio is: the model's tails are not known.
  static constexpr double kMostPerLook = 2.5;

 private:
  struct Learnt {
    double mean, variance, weight;
    void add(double value, double its_weight, double most_weight);
  };
  /// Looks that followed one that spoke for another place, and those of them that did as well.
  struct Streaks {
    double looks = 0, high = 0;
  };
  double ratio(double share, const Learnt& well) const;
  double ratioOfTails(double share, const Learnt& well) const;
  void countStreak(bool is_high, double news);
  void learnStreaks();
  double mostInStreak() const;

  // What is expected before anything was seen counts as much as the weights say.
  Learnt well_{0.03, 0.003, 20}, unbroken_{0.03, 0.003, 20}, wrong_{0.7, 0.05, 4};
  double evidence_ = -kUnbroken, dismissed_ = 0, last_time_s_ = 0;
  double odd_ = 0;  ///< looks that would have spoken for another place while all was well
  bool has_time_ = false, was_high_ = false;
  double look_news_ = 0, high_news_ = 0;  ///< of the look that is being made
  Streaks streaks_, undecided_;
};

}  // namespace slam::graph
