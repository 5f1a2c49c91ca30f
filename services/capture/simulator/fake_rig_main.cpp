#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <string>

#include "capture/simulator/simulated_rig.h"

namespace {

/// Reads faults from the standard input, one a line, until it ends.
int ObeyUntilEnd(drupe::SimulatedRig& rig) {
  std::string line;
  while (std::getline(std::cin, line)) {
    if (line.empty()) continue;
    const drupe::Result<std::string> answer = rig.Obey(line);
    std::printf("%s\n", answer.ok() ? answer->c_str() : answer.status().ToString().c_str());
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  drupe::SimulatedRigOptions options;
  std::string pictures = options.pictures;
  double loss_per_thousand = 0;
  CLI::App app(
      "A rig without hardware: a GigE Vision camera on the loopback network that sees a turntable's pictures, and\n"
      "the turntable behind a GRBL controller on a pseudo-terminal. Prints where both are, then takes faults from\n"
      "its standard input, one a line, and ends with it: status, unplug, plug, loss PER_THOUSAND, blur FRAMES,\n"
      "alarm, skip PULSES, turn DEGREES, silence, speak.");
  app.add_option("--pictures", pictures, "Directory of one turn's pictures, in order")->capture_default_str();
  app.add_option("--address", options.address, "Address on the loopback network (127.x.x.x)")->capture_default_str();
  app.add_option("--serial", options.serial, "The camera's serial number")->capture_default_str();
  app.add_option("--loss", loss_per_thousand, "Packets lost of a thousand")->capture_default_str();
  app.add_option("--seed", options.seed, "Chooses which packets are lost")->capture_default_str();
  app.add_flag("--spin", options.spin, "The table turns by itself, at --speed");
  app.add_option("--speed", options.spin_deg_s, "Degrees a second with --spin")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  options.pictures = pictures;
  options.loss = loss_per_thousand / 1000;
  const auto rig = drupe::SimulatedRig::Start(options);
  if (!rig.ok()) {
    std::fprintf(stderr, "drupe-fake-rig: %s\n", rig.status().ToString().c_str());
    return 1;
  }
  std::printf("%s\n", (*rig)->Obey("status")->c_str());
  std::fflush(stdout);
  return ObeyUntilEnd(**rig);
}
