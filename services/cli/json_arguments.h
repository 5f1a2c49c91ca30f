#pragma once

#include <optional>
#include <string>

#include "base/json.h"
#include "base/status.h"
#include "scene/board.h"
#include "scene/class_model.h"
#include "scene/colour_model.h"

namespace drupe {

/// A JSON argument of the command line: a file's name, or the JSON itself when it begins with a brace. Empty: null.
/// Errors: those of reading and parsing, with the file's name.
Result<Json> LoadJsonArgument(const std::string& argument);

/// A board argument: "default", a board.json's name, or its JSON. Empty: no board.
Result<std::optional<Board>> LoadBoardArgument(const std::string& argument);

/// A background model's argument: "default", or a model file's name.
Result<ColourModel> LoadModelArgument(const std::string& argument);

/// A classifier's argument: a model file's name. Empty: none, that is the rules.
Result<std::optional<ClassModel>> LoadClassModelArgument(const std::string& argument);

}  // namespace drupe
