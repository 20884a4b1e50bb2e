// Runs the built programs as a user would, for tests.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {

inline std::string content_of(const std::filesystem::path& file) {
  std::ifstream in{file, std::ios::binary};
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

struct Finished {
  int exit_code = -1;  // -1: ended by a signal
  std::string out, err;
};

// A program that runs, its output going to files in `folder`, which is its working folder too.
class Running {
 public:
  // arguments[0] is "stillcut" or "stillcutd"; `input`, where it is named, is what stands on its standard input.
  Running(const std::vector<std::string>& arguments, std::filesystem::path folder,
          const std::filesystem::path& input = {})
      : folder_{std::move(folder)} {
    const std::string program = std::string(STILLCUT_PROGRAMS "/") + arguments.at(0);
    std::vector<char*> argv;
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    const std::string out = (folder_ / "stdout").string(), err = (folder_ / "stderr").string();
    pid_ = fork();
    if (pid_ < 0) throw std::runtime_error("cannot fork");
    if (pid_ > 0) return;
    const int out_file = open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int err_file = open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const bool heard = input.empty() || dup2(open(input.c_str(), O_RDONLY), STDIN_FILENO) >= 0;
    const bool ready = heard && chdir(folder_.c_str()) == 0 && dup2(out_file, STDOUT_FILENO) >= 0 &&
                       dup2(err_file, STDERR_FILENO) >= 0;
    if (ready) execv(program.c_str(), argv.data());
    _exit(127);
  }
  ~Running() {
    if (pid_ < 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  void signal(int number) const { kill(pid_, number); }

  Finished wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content_of(folder_ / "stdout"),
            content_of(folder_ / "stderr")};
  }

 private:
  std::filesystem::path folder_;
  pid_t pid_ = -1;
};

inline Finished run(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                    const std::filesystem::path& input = {}) {
  return Running{arguments, folder, input}.wait();
}

// A folder with a copy of the demo cell, to be changed.
class DemoCell : public TempFolder {
 public:
  DemoCell() { std::filesystem::copy(EXAMPLES "/demo-cell", path(), std::filesystem::copy_options::recursive); }

  // Writes cell.toml with every `from` replaced, which must be there; an empty `to` takes it out.
  void change(const std::string& from, const std::string& to, const std::string& file = "cell.toml") const {
    std::string text = content_of(path() / file);
    const auto at = text.find(from);
    if (at == std::string::npos) throw std::runtime_error(file + " has no '" + from + "'");
    text.replace(at, from.size(), to);
    (void)write(file, text);
  }

  // A short simulated cut, with what its sensors send in cut.log: sound at first, then chatter.
  void simulate(const std::string& duration_s, const std::string& depth) const {
    const Finished done = run({"stillcut", "simulate", EXAMPLES "/demo-cell/cell.toml", "--duration", duration_s,
                               "--depth", depth, "--can", (path() / "cut.log").string(), "--json"},
                              path());
    if (done.exit_code != 0) throw std::runtime_error("simulate: " + done.err);
  }
};

}  // namespace stillcut
