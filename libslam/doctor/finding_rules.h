#pragma once
#include <string>
#include <utility>
#include <vector>

#include "libslam/doctor/log_check.h"

namespace slam::doctor {

/// What the figures of a log say of it, rule by rule: of the scans and their stamps (scan_findings.cpp), of
/// what motion shows of lidar and odometry (motion_findings.cpp).
class FindingRules {
 public:
  explicit FindingRules(const LogFigures& figures) : f_(figures) {}
  std::vector<Finding> all();

 private:
  void say(const char* key, Severity severity, std::string what, std::string advice = "");
  bool isInMetres() const { return f_.ranges.median_m < 60; }
  bool isViewWrong() const;

  void format();
  void damage();
  void skipped();
  void scans();
  void stamps();
  bool sharesStamps(const calibration::StreamFigures& stream) const;
  void units();
  void geometry();
  void noReturns();
  void lost();
  void beams();
  void duplicates();
  void truth();

  void matching();
  void view();
  static std::string sweepText(const calibration::Estimate& e);
  void sweep();
  double scanPeriod() const;
  void odometry();
  const calibration::OdometryFigures& best() const;
  void clock();
  static std::string shiftAdvice(const calibration::OdometryFigures& odometry);
  void scale();
  void disagreements();
  void mounting();

  const LogFigures& f_;
  std::vector<Finding> findings_;
};

}  // namespace slam::doctor
