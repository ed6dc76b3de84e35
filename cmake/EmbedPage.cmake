# Writes the files below FOLDER as arrays into OUTPUT, for tools/viewer/server.h, but for what only
# people and tests read.
file(GLOB_RECURSE files RELATIVE ${FOLDER} ${FOLDER}/*)
list(FILTER files EXCLUDE REGEX "(^|/)(README[.]md|package[.]json)$")
list(SORT files)
set(arrays "")
set(entries "")
set(count 0)
foreach(file IN LISTS files)
  file(READ ${FOLDER}/${file} bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  string(APPEND arrays "const unsigned char kFile${count}[] = {${bytes}0};\n")
  string(APPEND entries "    {\"${file}\", kFile${count}, sizeof(kFile${count}) - 1},\n")
  math(EXPR count "${count} + 1")
endforeach()
file(WRITE ${OUTPUT} "#include \"tools/viewer/server.h\"

namespace supple::tools {

namespace {

${arrays}
}  // namespace

extern const std::vector<EmbeddedFile> kEmbeddedPage = {
${entries}};

}  // namespace supple::tools
")
