// Reads from YADE's Boost.Python registration where a class keeps a member.
#pragma once

#include <string>

namespace cd_engine {

// Offset in bytes of `member`, which must be published by pointer-to-member with exactly this C++ type.
long publishedOffset(const char* className, const char* member, const std::string& type);

// Throws the one kind of refusal: what, what was expected, what was found, and what to do about it.
[[noreturn]] void refuse(const std::string& what, const std::string& expected, const std::string& found);

} // namespace cd_engine
