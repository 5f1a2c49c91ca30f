# Writes a C++ file in which drupe::SYMBOL, declared in http/contract_text.h, is the text of INPUT:
#   cmake -DINPUT=openapi.yaml -DSYMBOL=kOpenApiText -DOUTPUT=openapi_text.cpp -P embed_text.cmake
file(READ "${INPUT}" text)
file(WRITE "${OUTPUT}"
  "#include \"http/contract_text.h\"\n\nnamespace drupe {\n\nconst std::string_view ${SYMBOL} = R\"contract(${text})contract\";\n\n}  // namespace drupe\n")
