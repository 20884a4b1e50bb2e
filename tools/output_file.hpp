// A text file that a command writes, or standard output for the name "-".
#pragma once

#include <fstream>
#include <iostream>
#include <string>

#include "drivers/files/input_error.hpp"

namespace stillcut {

class OutputFile {
 public:
  // Throws InputError when the file cannot be opened.
  explicit OutputFile(const std::string& name) : name_{name} {
    if (name == "-") return;
    file_.open(name, std::ios::binary);
    if (!file_) throw InputError(name, 0, "cannot be written");
  }
  std::ostream& stream() { return name_ == "-" ? std::cout : file_; }

  // To be called after the last write. Throws InputError when not everything reached the file.
  void finish() {
    if (!stream().flush()) throw InputError(name_, 0, "cannot be written to the end; is the disk full?");
  }

 private:
  std::string name_;
  std::ofstream file_;
};

}  // namespace stillcut
