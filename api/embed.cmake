# Writes files as a C array of {name without ending, bytes with a terminating zero, number of bytes},
# by rising name, that ends with an empty element.
#
#   cmake -DOUTPUT=FILE.c -DHEADER=a/b.h -DTYPE=struct_type -DNAME=symbol "-DFILES=a.json;b.json" -P embed.cmake

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
  string(APPEND documents "static const unsigned char file_${n}[] = { ${bytes}0x00 };\n")
  string(APPEND entries "    { \"${name}\", (const char *)file_${n}, sizeof file_${n} - 1 },\n")
  math(EXPR n "${n} + 1")
endforeach()

file(WRITE ${OUTPUT} "#include \"${HEADER}\"

${documents}
const ${TYPE} ${NAME}[] = {
${entries}    { 0 },
};
")
