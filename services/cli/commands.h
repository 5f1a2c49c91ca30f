#pragma once

namespace CLI {
class App;
}

namespace drupe {

/// Each function adds one subcommand to `app`. When the user chooses it, the command runs after parsing and leaves its
/// result in `exit_code`: 0 done, 1 the work failed (the message is on stderr), 2 the arguments were wrong.
void AddRunCommand(CLI::App& app, int& exit_code);
void AddAnalyzeCommand(CLI::App& app, int& exit_code);
void AddModelCommand(CLI::App& app, int& exit_code);
void AddClassifierCommand(CLI::App& app, int& exit_code);
void AddCalibrateCommand(CLI::App& app, int& exit_code);
void AddBoardCommand(CLI::App& app, int& exit_code);
void AddVocabularyCommand(CLI::App& app, int& exit_code);
void AddStoreCommand(CLI::App& app, int& exit_code);
void AddBenchCommand(CLI::App& app, int& exit_code);

}  // namespace drupe
