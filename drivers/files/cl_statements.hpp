// APT cutter location text cut into statements: a major word and what stands behind its slash.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace stillcut {

struct ClStatement {
  std::string word;                // upper case: "GOTO", "TOOL PATH"
  std::vector<std::string> items;  // behind the slash, without blanks around them, upper case
  int line = 0;                    // where the statement begins
};

// Cuts the next statement off `text` and counts its lines in `line` (of what was read before); false at the end of the
// text. $$ begins a comment, $ at a line's end goes on in the next; words of free text (PARTNO, PPRINT, ...) take the
// whole line. Throws InputError: a continuation without a next line, or one without end;
// more items than a statement has.
bool next_cl_statement(std::string_view& text, const std::string& file, int& line, ClStatement& statement);

}  // namespace stillcut
