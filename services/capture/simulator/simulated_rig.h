#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <string>

#include "base/status.h"
#include "capture/simulator/gige_camera.h"
#include "capture/simulator/grbl_emulator.h"
#include "capture/simulator/picture_turn.h"
#include "capture/simulator/simulated_table.h"

namespace drupe {

struct SimulatedRigOptions {
  std::filesystem::path pictures = "tests/data/plum-s/images";
  std::string address = "127.0.0.1";
  std::string serial = "DRUPE-RIG";
  double loss = 0;  ///< share of the stream's packets that is lost, 0..1
  std::uint64_t seed = 1;
  bool spin = false;  ///< the table turns by itself, as one without a serial line does
  double spin_deg_s = 12;

  Status Check() const;
};

/// A rig without hardware: a GigE Vision camera that sees a turn of pictures, a turntable behind a GRBL controller on a
/// pseudo-terminal, and trigger pulses at every picture's angle.
class SimulatedRig {
 public:
  /// Errors: those of PictureTurn::Load, GrblEmulator::Start and GigeCamera::Plug.
  static Result<std::unique_ptr<SimulatedRig>> Start(const SimulatedRigOptions& options);

  /// The id that opens the camera through Aravis.
  std::string camera_id() const { return "Aravis-Fake-" + options_.serial; }
  const std::string& table_device() const { return grbl_->device(); }
  const PictureTurn& pictures() const { return pictures_; }
  GigeCamera& camera() { return *camera_; }
  SimulatedTable& table() { return *table_; }
  GrblEmulator& grbl() { return *grbl_; }
  /// Turns the table as by hand, and waits until it rests.
  void Turn(double degrees);
  /// Fault: the next `frames` frames are smeared.
  void BlurFrames(int frames) { blurred_frames_ = frames; }

  /// Obeys one line of text: "unplug", "plug", "loss PER_THOUSAND", "blur FRAMES", "alarm", "skip PULSES", "turn
  /// DEGREES", "silence", "speak". Returns what to answer: figures for "status". Errors: 400 `unknown_command`.
  Result<std::string> Obey(const std::string& command);

 private:
  SimulatedRig(const SimulatedRigOptions& options, PictureTurn pictures);
  Status StartParts();
  std::string Figures() const;

  const SimulatedRigOptions options_;
  const PictureTurn pictures_;
  std::atomic<int> blurred_frames_{0};
  std::unique_ptr<GigeCamera> camera_;
  std::unique_ptr<SimulatedTable> table_;  ///< pulses the camera, so it ends before it
  std::unique_ptr<GrblEmulator> grbl_;
};

}  // namespace drupe
