#pragma once

namespace slam::mapping {

/// Tells from scan after scan whether a robot is still where the map around it says: Page's cumulative sum of the log
/// likelihood ratio (a repeated sequential probability ratio test) of "carried elsewhere" over "well".
///
/// What a scan says is its contradicted share: of the points about which the map says anything, those in whose place it
/// saw that there is nothing. How large that is where all is well, and how much it varies, is learnt from the scans
/// themselves while they are well; how large it is where the robot is not, from scans put into wrong places on purpose.
/// Where a wrong place contradicts no more than the right one, nothing is ever said. The share is taken for one of
/// independent trials, of as many as its variation stands for (quasi-binomial).
///
/// Evidence counts by time and way, not by scan: a scan counts whole when kLook_s or kLook_m have passed since the one
/// before, less else, and never more.
///
/// Sources: Wald, Annals of Mathematical Statistics 16, 1945; Page, Biometrika 41, 1954; Wedderburn, Biometrika 61, 1974
/// (quasi-likelihood). Learning both sides while the robot drives is ours.
class LostDetector {
 public:
  /// A new look. contradicted: 0..1; telling: the share, 0..1, of the scan's points about which the map says anything. Times
  /// that run back count as none. may_be_lost: false where the map explains so much of the scan that it speaks against
  /// "carried elsewhere", or for nothing.
  void look(double time_s, double moved_m, double contradicted, double telling, bool may_be_lost = true);
  /// What a scan that was put into a wrong place on purpose says. Anything not finite counts as nothing.
  void learnWrong(double contradicted);

  /// For "carried elsewhere", in nats, 0 or more.
  double evidence() const { return evidence_; }
  bool isLost() const { return evidence_ >= kLost; }
  /// The last look spoke for it, and so do the last ones together: such a scan is better not believed.
  bool isInDoubt() const { return last_ > 0 && evidence_ >= kDoubt; }
  /// All is well again, or a new part begins: the evidence starts anew; what was learnt stays.
  void restart() { evidence_ = last_ = 0; }

  static constexpr double kLook_s = 0.4, kLook_m = 0.5;
  /// One false alarm in exp(kLost) looks (1.2 million) at most, as far as the model holds.
  static constexpr double kLost = 14;
  static constexpr double kDoubt = 1;
  /// One look says at most so much, however large the likelihood ratio is: the model's tails are not known.
  static constexpr double kMostPerLook = 2.5;

 private:
  struct Learnt {
    double mean, variance, weight;
    void add(double value, double its_weight, double most_weight);
  };
  // What is expected before anything was seen counts as much as the weights say.
  Learnt well_{0.03, 0.003, 20}, wrong_{0.4, 0.03, 4};
  double evidence_ = 0, last_ = 0, last_time_s_ = 0;
  bool has_time_ = false;
};

}  // namespace slam::mapping
