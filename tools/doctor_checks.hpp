// The checks of `stillcut doctor`, one function each; the table in doctor.cpp holds them all. A new one is written in
// the file of its subject, declared here, entered there, and given a fault of its own in tests/tools/doctor_test.cpp.
#pragma once

#include "tools/doctor.hpp"

namespace stillcut::doctor {

// A check's start: its name, and what it wants.
struct Subject {
  std::string name, wanted;

  [[nodiscard]] Check ok(std::string found) const { return {name, Health::ok, std::move(found), wanted, ""}; }
  [[nodiscard]] Check not_ok(std::string found, std::string mend) const {
    return {name, Health::not_ok, std::move(found), wanted, std::move(mend)};
  }
  [[nodiscard]] Check not_applicable(std::string why) const {
    return {name, Health::not_applicable, std::move(why), wanted, ""};
  }
};

// doctor_kernel.cpp
Check check_kernel(const Host& host, const DoctorWishes& wishes);
Check check_timer_resolution(const Host& host, const DoctorWishes& wishes);
Check check_clock_source(const Host& host, const DoctorWishes& wishes);
Check check_throttling(const Host& host, const DoctorWishes& wishes);
Check check_huge_pages(const Host& host, const DoctorWishes& wishes);
Check check_swap(const Host& host, const DoctorWishes& wishes);

// doctor_processors.cpp
Check check_isolated(const Host& host, const DoctorWishes& wishes);
Check check_tickless(const Host& host, const DoctorWishes& wishes);
Check check_interrupts(const Host& host, const DoctorWishes& wishes);
Check check_governor(const Host& host, const DoctorWishes& wishes);
Check check_idle_states(const Host& host, const DoctorWishes& wishes);

// doctor_limits.cpp
Check check_priority_limit(const Host& host, const DoctorWishes& wishes);
Check check_memory_limit(const Host& host, const DoctorWishes& wishes);

// doctor_can.cpp
Check check_receive_buffer(const Host& host, const DoctorWishes& wishes);
Check check_can_interface(const Host& host, const DoctorWishes& wishes);
// Those of doctor's that look at one interface; their names begin with the interface's.
std::vector<CanLink> can_links_in_use(const Host& host, const DoctorWishes& wishes);
Check check_can_up(const CanLink& link, const DoctorWishes& wishes);
Check check_can_mtu(const CanLink& link, const DoctorWishes& wishes);
Check check_can_bit_rate(const CanLink& link, const DoctorWishes& wishes);
Check check_can_data_bit_rate(const CanLink& link, const DoctorWishes& wishes);
Check check_can_state(const CanLink& link, const DoctorWishes& wishes);
Check check_can_errors(const CanLink& link, const DoctorWishes& wishes);
Check check_can_restart(const CanLink& link, const DoctorWishes& wishes);

// doctor_lcm.cpp
Check check_lcm_route(const Host& host, const DoctorWishes& wishes);
Check check_lcm_interface(const Host& host, const DoctorWishes& wishes);
Check check_lcm_hears_itself(const Host& host, const DoctorWishes& wishes);

// doctor_site.cpp: time of day and disk
Check check_clock_sync(const Host& host, const DoctorWishes& wishes);
Check check_disk_room(const Host& host, const DoctorWishes& wishes);

// Processors as the kernel lists them, "0-2,5"; nothing where the text is no such list.
std::optional<std::vector<int>> processor_list(const std::string& text);
std::string processor_text(const std::vector<int>& processors);
// Where the loop will run: the wished one, else the isolated ones that are online; may be none.
std::vector<int> loop_processors(const Host& host, const DoctorWishes& wishes);

// A word of the shell: in quotes where it needs them.
std::string shell_word(const std::string& text);

// A command that adds words to the kernel's command line (GRUB) for good; `topic` names its file.
std::string boot_with(const std::string& words, const std::string& topic);
inline const std::string kFullKernel = "apt-get install linux-image-rt-$(dpkg --print-architecture) && reboot";
inline const std::string kUnreadable = "cannot be read: ";

}  // namespace stillcut::doctor
