#include <CLI/CLI.hpp>

#include "cli/bench/bench.h"
#include "cli/commands.h"

namespace drupe {

void AddBenchCommand(CLI::App& app, int& exit_code) {
  CLI::App* bench = app.add_subcommand("bench", "Measure a stage on sets whose truth is known, beside its peers");
  bench->require_subcommand(1);
  AddBackgroundBench(*bench, exit_code);
  AddBayerBench(*bench, exit_code);
  AddContourBench(*bench, exit_code);
  AddDefectsBench(*bench, exit_code);
  AddDenseBench(*bench, exit_code);
  AddMatchingBench(*bench, exit_code);
  AddSegmentationBench(*bench, exit_code);
  AddSfmBench(*bench, exit_code);
}

}  // namespace drupe
