# Writes the ready scenarios as a C file.
#
#   cmake -DOUTPUT=FILE.c "-DFILES=a.json;b.json" -P embed_examples.cmake

set(names "")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME_WE)
  set(file_of_${name} ${file})
  list(APPEND names ${name})
endforeach()
list(SORT names)

set(documents "")
set(entries "")
set(n 0)
foreach(name IN LISTS names)
  file(READ ${file_of_${name}} hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
  string(APPEND documents "static const unsigned char document_${n}[] = { ${bytes}0x00 };\n")
  string(APPEND entries "    { \"${name}\", (const char *)document_${n}, "
                        "sizeof document_${n} - 1 },\n")
  math(EXPR n "${n} + 1")
endforeach()

file(WRITE ${OUTPUT} "#include \"api/scenario/examples_priv.h\"

${documents}
const example examples__list[] = {
${entries}};
const size_t examples__n = ${n};
")
