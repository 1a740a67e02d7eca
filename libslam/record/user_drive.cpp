#include "libslam/record/user_drive.h"

#include <cmath>
#include <cstdio>

namespace slam::record {
namespace {

/// Notes between the steps what the truth says of every command.
class OutcomeNotes : public StepObserver {
 public:
  explicit OutcomeNotes(StepObserver* next) : next_(next) {}

  /// The command that begins after the next look.
  void begin(const robot::UserCommand& command) { beginning_ = command; }
  void onStep(const Step& step) override {
    const auto& simulator = *step.simulator;
    path_.add(simulator.truth(), simulator.carries());
    if (under_way_) outcomes_.push_back(outcomeOf(*under_way_, simulator));
    under_way_ = beginning_;
    beginning_.reset();
    driven_m_ = path_.length_m();
    collisions_ = simulator.collisions().size();
    if (next_) next_->onStep(step);
  }
  std::vector<CommandOutcome> outcomes() && { return std::move(outcomes_); }

 private:
  CommandOutcome outcomeOf(const robot::UserCommand& command, const sim::Simulator& simulator) const {
    const bool collided = simulator.collisions().size() > collisions_;
    // A turn in place never collides.
    const double done = command.kind == robot::UserCommand::kTurn
                            ? command.amount
                            : std::copysign(path_.length_m() - driven_m_, command.amount);
    return {command, done, collided};
  }

  StepObserver* next_;
  sim::DrivenPath path_;
  std::optional<robot::UserCommand> beginning_, under_way_;
  double driven_m_ = 0;
  std::size_t collisions_ = 0;
  std::vector<CommandOutcome> outcomes_;
};

}  // namespace

UserDrive recordUserCommands(const world::Plan& given_plan, const RecordConfig& config, std::uint64_t seed,
                             const std::string& log_path, const std::vector<robot::UserCommand>& commands,
                             resources::Manifest manifest, core::Progress& progress, StepObserver* observer) {
  OutcomeNotes notes(observer);
  std::size_t next = 0;
  const auto commander = [&](const sim::Sensed&) -> std::optional<Order> {
    if (next == commands.size()) return std::nullopt;
    notes.begin(commands[next]);
    return Order(robot::toCommand(commands[next++], config.robot), true);
  };
  UserDrive drive;
  drive.recording =
      recordCommands(given_plan, config, seed, log_path, std::move(manifest), progress, commander, &notes);
  drive.outcomes = std::move(notes).outcomes();
  return drive;
}

std::string outcomeText(const CommandOutcome& outcome) {
  if (!outcome.collided) return "";
  char text[120];
  std::snprintf(text, sizeof text, "line %d: %s ended at an obstacle after %.3f m", outcome.command.line,
                robot::formatUserCommand(outcome.command).c_str(), outcome.done);
  return text;
}

}  // namespace slam::record
