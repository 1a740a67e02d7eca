#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libslam/score/evaluate.h"
#include "libslam/score/relation_tables.h"
#include "libslam/stats/paired.h"
#include "libslam/table/table.h"

namespace slam::score {

/// A figure of one cell (a method; in a sweep the method with its world, robot and so on), once per seed, in
/// the order of the seeds. A run that failed is stats::failedValue().
struct Score {
  std::string cell, metric;
  std::vector<double> values;
  std::vector<std::uint64_t> seeds = {};  ///< of the values; none: not known
};

/// A figure as it was, and how much worse it may be: by absolute, or by relative times its size, whichever is
/// more.
struct GateRow {
  Score baseline;
  stats::Better better = stats::Better::kSmaller;
  double relative = 0, absolute = 0;
};

/// What figures are held against.
struct Gate {
  double alpha = 0.05;  ///< a difference with a p-value above it may be chance
  std::vector<GateRow> rows;
};

/// The file: {"alpha": 0.05, "rows": [{"cell": "graph", "metric": "ate_rmse_m", "better": "smaller", "value":
/// 0.012, "relative": 0.1, "absolute": 0.001}, ...]}, or "values" with one per seed instead of "value", which
/// "seeds" may name; null is a failed run. Left out, alpha is 0.05 and a tolerance is 0. Errors: InputError
/// with the file, the row and the key: not JSON, no row, a key that is missing, unknown or of another kind, a
/// negative tolerance, alpha outside (0, 1), a cell's metric twice, seeds that are not as many as the values,
/// or one of them twice.
Gate readGate(const std::string& path);
/// Writes what readGate() reads. REQUIRES rows with values, none NaN (ContractError). Errors: IoError.
void writeGate(const Gate& gate, const std::string& path);

/// One row per score with its value as the baseline and the tolerances that stand for no other knowledge: 10
/// %, and one unit of the last digit that tables show. Of `old` the tolerances of the same cell's metric are
/// kept, and its rows of other cells. Left out are metrics for which neither direction is better or that
/// depend on the machine, and scores without a finite value or with one that is NaN.
Gate updatedGate(const Gate& old, const std::vector<Score>& scores);
/// Every metric of a run, those that depend on the machine too.
std::vector<Score> scoresOf(const Evaluation& evaluation);
/// The benchmark's two figures of every path, translation_mean_m and rotation_mean_deg; the cell is the path.
std::vector<Score> scoresOf(const std::vector<RelationScore>& relation_scores);

/// The rows of the cells that were measured, for whoever measured only some. Errors: InputError when there is
/// none, and when a row names a metric that is not among its cell's scores (one that is NaN is).
Gate rowsOfMeasured(const Gate& gate, const std::vector<Score>& scores, const std::string& gate_path);

enum class GateVerdict {
  kWithin,   ///< of its tolerance
  kBetter,   ///< by more than the tolerance: time for a new baseline
  kUnsure,   ///< worse by more than the tolerance, but no more than chance can explain
  kWorse,    ///< worse by more than the tolerance, or more runs failed than before
  kMissing,  ///< not measured
};

struct GateFinding {
  GateRow row;
  std::vector<double> values;  ///< as measured; none: missing
  double before = 0, now = 0;  ///< medians over the seeds, failed runs among them
  double allowed = 0;          ///< how much worse `now` may be than `before`
  std::optional<double>
      p;  ///< of the signed-rank test, where as many seeds were measured as before, and two or more
  GateVerdict verdict = GateVerdict::kMissing;
};

/// Holds what was measured against each row of the gate, in its order. Values pair up by their seeds, of
/// which those count that both have; where seeds are not known by their place in the lists.
/// Chance excuses a worse median only where it could be told from one: by p above alpha with enough pairs for
/// p to get down to alpha (6 for 0.05); with fewer the tolerance alone decides. Scores without a row are not
/// looked at. Each row is tested by itself, so of many rows some will be called worse by chance; the
/// tolerance is what keeps them few.
std::vector<GateFinding> checkGate(const Gate& gate, const std::vector<Score>& scores);
/// Whether one of them is worse or missing.
bool gateIsShut(const std::vector<GateFinding>& findings);

/// kShort: the rows that are not within their tolerance; kFull: all. The first note counts the verdicts.
table::Table gateTable(const std::vector<GateFinding>& findings, const std::string& gate_path, Detail detail);

}  // namespace slam::score
