# Writes a text file as a C array with a terminating zero.
#
#   cmake -DOUTPUT=FILE.c -DFILE=TEXT -DHEADER=a/b.h -DNAME=symbol -P embed_text.cmake

file(READ ${FILE} hex HEX)
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
file(WRITE ${OUTPUT} "#include \"${HEADER}\"

const char ${NAME}[] = { ${bytes}0x00 };
")
