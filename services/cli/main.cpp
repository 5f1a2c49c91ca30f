#include <CLI/CLI.hpp>

#include "base/version.h"
#include "cli/commands.h"

int main(int argc, char** argv) {
  CLI::App app{
      "Drupe rebuilds a small fruit in 3D from turntable photographs and measures its surface defects.\n\n"
      "  drupe board --out board/                           print a board for the turntable\n"
      "  drupe calibrate CHECKERBOARD_DIR --pattern pattern.json --out calibration.json\n"
      "  drupe run IMAGES_DIR --calibration calibration.json --board default --out result/"};
  app.set_version_flag("--version", drupe::kVersion);
  app.require_subcommand(1);
  int exit_code = 0;
  drupe::AddRunCommand(app, exit_code);
  drupe::AddAnalyzeCommand(app, exit_code);
  drupe::AddModelCommand(app, exit_code);
  drupe::AddClassifierCommand(app, exit_code);
  drupe::AddCalibrateCommand(app, exit_code);
  drupe::AddBoardCommand(app, exit_code);
  drupe::AddVocabularyCommand(app, exit_code);
  drupe::AddStoreCommand(app, exit_code);
  drupe::AddBenchCommand(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return exit_code;
}
