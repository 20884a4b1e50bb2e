#include "tools/tap_dialog.hpp"

#include <cstdio>
#include <istream>
#include <ostream>
#include <stdexcept>

#include "tools/tap_report.hpp"

namespace stillcut {
namespace {

enum class TapAnswer { accept, repeat, quit };

// Anything but a, r or q is asked again; the end of the answers is a q.
TapAnswer ask_for_verdict(std::istream& answers, std::ostream& out) {
  std::string line;
  for (;;) {
    out << "[a]ccept, [r]epeat, [q]uit? " << std::flush;
    if (!std::getline(answers, line)) {
      out << '\n';
      return TapAnswer::quit;
    }
    if (line == "a" || line == "accept") return TapAnswer::accept;
    if (line == "r" || line == "repeat") return TapAnswer::repeat;
    if (line == "q" || line == "quit") return TapAnswer::quit;
  }
}

// So many sound hits, each told of.
std::vector<TapRecording> collect_hits(const TapQuestion& question, const TapSource& source, std::ostream& out) {
  std::vector<TapRecording> sound;
  while (static_cast<int>(sound.size()) < question.hits) {
    HeardTap heard = source.next();
    const bool good = heard.refusal.empty();
    if (good) sound.push_back(std::move(heard.recording));
    std::array<char, 64> text{};
    const int number = static_cast<int>(sound.size()) + (good ? 0 : 1);
    if (heard.peak_n > 0.0)
      (void)std::snprintf(text.data(), text.size(), "  hit %d of %d: %.0f N, ", number, question.hits, heard.peak_n);
    else
      (void)std::snprintf(text.data(), text.size(), "  hit %d of %d: ", number, question.hits);
    out << text.data() << (good ? "sound" : "refused, " + heard.refusal) << std::endl;
  }
  return sound;
}

}  // namespace

std::string direction_name(HammerDirection hammer) {
  return std::string(hammer.sense < 0.0 ? "-" : "") + "xyz"[hammer.axis];
}

std::optional<TappedDirection> ask_for_taps(const TapQuestion& question, TapSettings settings, const TapSource& source,
                                            std::istream& answers, std::ostream& out) {
  settings.force_axis = question.hammer.axis;
  settings.force_sense = question.hammer.sense;
  for (;;) {
    source.forget();
    out << "posture " << question.posture << ", hammer towards " << direction_name(question.hammer) << ": hit "
        << question.hits << " times, at rest before each, and wait " << settings.record_s << " s after it" << std::endl;
    TappedDirection tapped{question.hammer, collect_hits(question, source, out), {}};
    tapped.estimate = estimate_taps(tapped.recordings, settings);
    print_quality(tapped.estimate, tapped.hammer, out);
    switch (ask_for_verdict(answers, out)) {
      case TapAnswer::accept:
        return tapped;
      case TapAnswer::quit:
        return {};
      case TapAnswer::repeat:
        break;
    }
  }
}

}  // namespace stillcut
