// Reads the offset of a class member from YADE's Boost.Python registration.
#pragma once

#include <string>

namespace cd_engine {

// Offset in bytes of `member`, which must be published by pointer-to-member with exactly this C++ type.
long publishedOffset(const char* className, const char* member, const std::string& type);

// Throws the LayoutError of every refusal, which says what was checked, expected and found, and what to do.
[[noreturn]] void refuse(const std::string& what, const std::string& expected, const std::string& found);

} // namespace cd_engine
