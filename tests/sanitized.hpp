// Sanitizers make arithmetic many times slower, and what they look for is seen in a few cases of a long series.
#pragma once

namespace stillcut::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace stillcut::test
