#pragma once

#include <string_view>

namespace drupe {

/// The texts of api/openapi.yaml and of the schema it refers to, as they were when this was built; made by
/// embed_text.cmake.
extern const std::string_view kOpenApiText;
extern const std::string_view kReportSchemaText;

}  // namespace drupe
