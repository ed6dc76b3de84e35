#include "volumes/io/tiff/tiff_library.h"

#include <cstdio>

namespace supple {

namespace {

int keep_message(TIFF*, void* user_data, const char*, const char* format, va_list arguments) {
  char text[200];
  std::vsnprintf(text, sizeof text, format, arguments);
  auto* message = static_cast<std::string*>(user_data);
  if (message->empty()) *message = text;
  return 1;
}

int ignore_message(TIFF*, void*, const char*, const char*, va_list) {
  return 1;
}

}  // namespace

TIFF* open_tiff_quietly(const std::string& path, const std::string& mode, std::string& message) {
  TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
  TIFFOpenOptionsSetErrorHandlerExtR(options, keep_message, &message);
  TIFFOpenOptionsSetWarningHandlerExtR(options, ignore_message, nullptr);
  TIFFOpenOptionsSetMaxSingleMemAlloc(options, kMaxTiffAllocation);
  TIFF* tiff = TIFFOpenExt(path.c_str(), (mode + "m").c_str(), options);
  TIFFOpenOptionsFree(options);
  return tiff;
}

}  // namespace supple
