// The connection to the LCM network. Publishing and receiving may share one, from different threads; in-process
// (memq://) they must, as messages do not leave it.
#pragma once

#include <lcm/lcm.h>

#include <memory>
#include <string>

namespace stillcut {

using LcmConnection = std::shared_ptr<lcm_t>;

// Opens "udpm://GROUP:PORT?ttl=N" (other processes and hosts) or "memq://" (within the process). Throws ComponentError,
// with the commands that mend it, when there is no way to the multicast group. LCM starts a thread of its own, which
// inherits the caller's scheduling: open before the real-time thread is set up, or on another thread.
LcmConnection open_lcm(const std::string& url);

}  // namespace stillcut
