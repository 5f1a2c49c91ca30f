# Writes a C++ file whose drupe::kOpenApiText is the text of INPUT:
#   cmake -DINPUT=openapi.yaml -DOUTPUT=openapi_text.cpp -P embed_text.cmake
file(READ "${INPUT}" text)
file(WRITE "${OUTPUT}"
  "#include \"http/openapi_text.h\"\n\nnamespace drupe {\n\nconst std::string_view kOpenApiText = R\"openapi(${text})openapi\";\n\n}  // namespace drupe\n")
