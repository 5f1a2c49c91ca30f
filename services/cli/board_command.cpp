#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "base/files.h"
#include "base/json.h"
#include "capture/board/board_print.h"
#include "cli/commands.h"

namespace drupe {
namespace {

/// What the user wrote after `drupe board`.
struct BoardArguments {
  BoardPrintOptions print;
  double dpi = 600;
  bool no_speckle = false;
  std::string out = ".";
};

Status WriteBoard(BoardArguments& arguments) {
  namespace fs = std::filesystem;
  arguments.print.speckle = !arguments.no_speckle;
  DRUPE_ASSIGN_OR_RETURN(const BoardDrawing drawing, DrawBoard(arguments.print));
  DRUPE_ASSIGN_OR_RETURN(const std::string png, ToPng(drawing, arguments.dpi));
  const fs::path out = arguments.out;
  std::error_code error;
  fs::create_directories(out, error);
  if (error) return StatusFromErrno(error.value(), "create", out);
  DRUPE_RETURN_IF_ERROR(WriteFileAtomically(out / "board.svg", ToSvg(drawing)));
  DRUPE_RETURN_IF_ERROR(WriteFileAtomically(out / "board.pdf", ToPdf(drawing)));
  DRUPE_RETURN_IF_ERROR(WriteFileAtomically(out / "board.png", png));
  DRUPE_RETURN_IF_ERROR(WriteFileAtomically(out / "board.json", DumpJson(ToJson(BoardOf(arguments.print))) + "\n"));
  std::printf(
      "%s: board.pdf, board.svg and board.png, %g x %g mm, and board.json.\n"
      "Print at 100 %% on matt paper, glue it on a flat plate and measure the ruler. If it is not exactly to scale, "
      "run\n"
      "this again with --measured-ruler-mm set to what the whole ruler, scaled to 100 mm, measures.\n",
      out.c_str(), drawing.width_mm, drawing.height_mm);
  return Status::Ok();
}

void AddOptions(CLI::App& command, BoardArguments& arguments) {
  BoardPrintOptions& print = arguments.print;
  command.add_option("--columns", print.columns, "Markers a row")->capture_default_str();
  command.add_option("--rows", print.rows, "Markers a column")->capture_default_str();
  command.add_option("--marker-mm", print.marker_mm, "Side of a marker")->capture_default_str();
  command.add_option("--pitch-mm", print.pitch_mm, "From one marker to the next")->capture_default_str();
  command.add_option("--dictionary", print.dictionary, "Dictionary of the markers")->capture_default_str();
  command.add_flag("--no-speckle", arguments.no_speckle, "No dots between the markers");
  command.add_option("--seed", print.seed, "Seed of the dots")->capture_default_str();
  command
      .add_option("--measured-ruler-mm", print.measured_ruler_mm,
                  "What 100 mm of the printed ruler measure; scales board.json")
      ->capture_default_str();
  command.add_option("--dpi", arguments.dpi, "Resolution of board.png")->capture_default_str();
  command.add_option("--out", arguments.out, "Directory to write to")->capture_default_str();
}

}  // namespace

void AddBoardCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<BoardArguments>();
  CLI::App* command =
      app.add_subcommand("board", "The printable board of markers for the turntable (PDF, SVG, PNG, JSON)");
  AddOptions(*command, *arguments);
  command->callback([arguments, &exit_code] {
    const Status status = WriteBoard(*arguments);
    if (status.ok()) return;
    std::fprintf(stderr, "drupe board: %s\n", status.ToString().c_str());
    exit_code = status.kind() == StatusKind::kInvalidArgument ? 2 : 1;
  });
}

}  // namespace drupe
