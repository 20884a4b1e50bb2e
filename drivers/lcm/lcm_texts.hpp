// The .lcm files of this folder, as they are; CMakeLists.txt makes lcm_texts.cpp of them.
#pragma once

#include <span>

namespace stillcut {

extern const std::span<const char* const> kLcmTexts;

}  // namespace stillcut
