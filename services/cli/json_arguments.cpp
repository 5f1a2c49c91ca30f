#include "cli/json_arguments.h"

#include <utility>

#include "base/files.h"
#include "defect_analysis/models/default_model.h"

namespace drupe {

namespace {

constexpr std::size_t kMaxJsonFileBytes = 8 << 20;

}  // namespace

Result<Json> LoadJsonArgument(const std::string& argument) {
  if (argument.empty()) return Json(nullptr);
  if (argument.front() == '{') return ParseJson(argument);
  DRUPE_ASSIGN_OR_RETURN(const std::string text, ReadFile(argument, kMaxJsonFileBytes));
  Result<Json> json = ParseJson(text, {.max_bytes = kMaxJsonFileBytes});
  if (json.ok()) return json;
  return Status(json.status().kind(), json.status().code(), argument + ": " + json.status().message());
}

Result<std::optional<Board>> LoadBoardArgument(const std::string& argument) {
  if (argument.empty()) return std::optional<Board>();
  if (argument == "default") return std::optional<Board>(MakeGridBoard());
  DRUPE_ASSIGN_OR_RETURN(const Json json, LoadJsonArgument(argument));
  DRUPE_ASSIGN_OR_RETURN(Board board, ParseBoard(json));
  return std::optional<Board>(std::move(board));
}

Result<ColourModel> LoadModelArgument(const std::string& argument) {
  if (argument == "default") return DefaultBackgroundModel();
  DRUPE_ASSIGN_OR_RETURN(const Json json, LoadJsonArgument(argument));
  return ParseColourModel(json);
}

Result<std::optional<ClassModel>> LoadClassModelArgument(const std::string& argument) {
  if (argument.empty()) return std::optional<ClassModel>();
  DRUPE_ASSIGN_OR_RETURN(const Json json, LoadJsonArgument(argument));
  DRUPE_ASSIGN_OR_RETURN(ClassModel model, ParseClassModel(json));
  return std::optional<ClassModel>(std::move(model));
}

}  // namespace drupe
