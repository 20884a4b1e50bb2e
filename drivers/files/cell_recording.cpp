#include "drivers/files/cell_sections.hpp"

namespace stillcut {

RecordingSettings read_recording(TomlSection section, const std::filesystem::path& folder) {
  constexpr Bounds kSegment = from(1, 3600), kMib = from(1, 1e8), kAboutAMark = from(0, 3600);
  RecordingSettings settings;
  settings.folder = (folder / section.text("folder")).lexically_normal();
  settings.segment_s = section.number("segment_s", kSegment, settings.segment_s);
  settings.keep_mib = section.number("keep_mib", kMib, settings.keep_mib);
  settings.keep_marked_mib = section.number("keep_marked_mib", kMib, settings.keep_marked_mib);
  settings.mark_before_s = section.number("mark_before_s", kAboutAMark, settings.mark_before_s);
  settings.mark_after_s = section.number("mark_after_s", kAboutAMark, settings.mark_after_s);
  settings.only_marks = section.truth("only_marks", settings.only_marks);
  section.finish();
  return settings;
}

}  // namespace stillcut
