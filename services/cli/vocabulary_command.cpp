#include <CLI/CLI.hpp>
#include <cstdio>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "base/files.h"
#include "cli/commands.h"
#include "cli/exit_code.h"
#include "cli/json_arguments.h"
#include "cli/source_images.h"
#include "reconstruction/similarity/vocabulary.h"
#include "reconstruction/view_features.h"

namespace drupe {

namespace {

/// What the user wrote after `drupe vocabulary`.
struct VocabularyArguments {
  std::vector<std::string> images;
  std::string out;
  std::string options;
  int threads = 0;
};

/// The features of all pictures of all directories; each directory may have a picture size of its own.
Result<std::vector<Features>> FeaturesOf(const VocabularyArguments& arguments, const ReconstructionOptions& options,
                                         const RunContext& context) {
  std::vector<Features> all;
  for (const std::string& directory : arguments.images) {
    ReconstructionInput input;
    DRUPE_ASSIGN_OR_RETURN(input.images, LoadSourceImages(directory, input.limits));
    DRUPE_ASSIGN_OR_RETURN(ViewFeatures views, FindViewFeatures(input, options, context));
    std::move(views.features.begin(), views.features.end(), std::back_inserter(all));
  }
  return all;
}

Status Train(const VocabularyArguments& arguments) {
  DRUPE_ASSIGN_OR_RETURN(const Json json, LoadJsonArgument(arguments.options));
  DRUPE_ASSIGN_OR_RETURN(const ReconstructionOptions options, ParseReconstructionOptions(json));
  RunContext context;
  context.threads = arguments.threads;
  DRUPE_ASSIGN_OR_RETURN(const std::vector<Features> features, FeaturesOf(arguments, options, context));
  DRUPE_ASSIGN_OR_RETURN(const std::string vocabulary, TrainVocabulary(features, options.similarity, context));
  DRUPE_RETURN_IF_ERROR(WriteFileAtomically(arguments.out, vocabulary));
  std::printf("%s: trained on %zu pictures, %zu bytes\n", arguments.out.c_str(), features.size(), vocabulary.size());
  return Status::Ok();
}

}  // namespace

void AddVocabularyCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<VocabularyArguments>();
  CLI::App* command = app.add_subcommand(
      "vocabulary",
      "Train the words by which pictures are compared, for sets that are too small to train their own:\n"
      "`drupe run ... --options '{\"similarity\": {\"vocabulary\": \"FILE\"}}'` uses them");
  command->add_option("IMAGES_DIR", arguments->images, "Directories of pictures")->required();
  command->add_option("--out", arguments->out, "File to write")->required();
  command->add_option("--options", arguments->options,
                      "Options of the reconstruction, of which features and similarity count: a JSON file, or JSON");
  command->add_option("--threads", arguments->threads, "Threads; 0: one a core")->check(CLI::Range(0, 1024));
  command->callback([arguments, &exit_code] { exit_code = CommandExitCode("drupe vocabulary", Train(*arguments)); });
}

}  // namespace drupe
