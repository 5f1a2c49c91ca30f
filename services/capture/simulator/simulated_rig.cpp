#include "capture/simulator/simulated_rig.h"

#include <chrono>
#include <sstream>
#include <thread>

#include "base/json.h"

namespace drupe {
namespace {

constexpr int kBlurPx = 6;
constexpr double kManyTurnsDeg = 360e6;
constexpr double kByHandDegS = 720;

}  // namespace

Status SimulatedRigOptions::Check() const {
  if (!(loss >= 0 && loss < 1)) return InvalidArgument("invalid_option", "loss must be 0 to 1, less than 1", "loss");
  if (!(spin_deg_s > 0 && spin_deg_s <= 360)) {
    return InvalidArgument("invalid_option", "the table's speed must be above 0, to 360", "spin_deg_s");
  }
  if (serial.empty() || serial.size() > 15) {
    return InvalidArgument("invalid_option", "the serial number must have 1 to 15 characters", "serial");
  }
  return Status::Ok();
}

SimulatedRig::SimulatedRig(const SimulatedRigOptions& options, PictureTurn pictures)
    : options_(options), pictures_(std::move(pictures)) {}

Result<std::unique_ptr<SimulatedRig>> SimulatedRig::Start(const SimulatedRigOptions& options) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  DRUPE_ASSIGN_OR_RETURN(PictureTurn pictures, PictureTurn::Load(options.pictures));
  std::unique_ptr<SimulatedRig> rig(new SimulatedRig(options, std::move(pictures)));
  DRUPE_RETURN_IF_ERROR(rig->StartParts());
  return rig;
}

Status SimulatedRig::StartParts() {
  const GigeCameraOptions camera{options_.address, options_.serial, pictures_.width(), pictures_.height(),
                                 options_.seed};
  camera_ = std::make_unique<GigeCamera>(
      camera, [this](std::optional<double> table_deg, const SensorWindow& window, std::span<std::uint8_t> pixels) {
        const int blur = blurred_frames_ > 0 && blurred_frames_-- > 0 ? kBlurPx : 0;
        pictures_.Expose(table_deg.value_or(table_->position_deg()), blur, window, pixels);
      });
  table_ = std::make_unique<SimulatedTable>(
      pictures_.step_deg(),
      [this](double table_deg, SimulatedTable::TimePoint passed) { camera_->PulseLine(table_deg, passed); });
  DRUPE_ASSIGN_OR_RETURN(grbl_, GrblEmulator::Start(*table_));
  camera_->set_loss(options_.loss);
  if (options_.spin) table_->Move(kManyTurnsDeg, options_.spin_deg_s);
  return camera_->Plug();
}

std::string SimulatedRig::Figures() const {
  return DumpJson({{"camera", camera_id()},
                   {"table", table_device()},
                   {"angle_deg", table_->position_deg()},
                   {"frames_sent", camera_->frames_sent()},
                   {"packets_lost", camera_->packets_lost()},
                   {"packets_resent", camera_->packets_resent()}});
}

void SimulatedRig::Turn(double degrees) {
  table_->Move(degrees, kByHandDegS);
  while (table_->moving()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

Result<std::string> SimulatedRig::Obey(const std::string& command) {
  std::istringstream words(command);
  std::string verb;
  double number = 1;
  words >> verb >> number;
  if (words.fail()) number = 1;
  if (verb == "status") return Figures();
  if (verb == "unplug") {
    camera_->Unplug();
  } else if (verb == "plug") {
    DRUPE_RETURN_IF_ERROR(camera_->Plug());
  } else if (verb == "loss") {
    camera_->set_loss(number / 1000);
  } else if (verb == "blur") {
    BlurFrames(static_cast<int>(number));
  } else if (verb == "alarm") {
    grbl_->RaiseAlarm();
  } else if (verb == "skip") {
    table_->SkipPulses(static_cast<int>(number));
  } else if (verb == "turn") {
    Turn(number);
  } else if (verb == "silence" || verb == "speak") {
    grbl_->set_silent(verb == "silence");
  } else {
    return InvalidArgument("unknown_command",
                           "the commands are status, unplug, plug, loss PER_THOUSAND, blur FRAMES, "
                           "alarm, skip PULSES, turn DEGREES, silence, speak");
  }
  return std::string("ok");
}

}  // namespace drupe
