// How a cell file names signals of the DBC file: "Message.Signal", or "Message.Signal{a..b}" for the numbered signals
// Signal<a> to Signal<b>, and how they are found.
#pragma once

#include <string>
#include <vector>

#include "drivers/can/dbc.hpp"

namespace stillcut {

// Where a reference stands, for messages to the user.
struct CellKey {
  std::string file;
  int line = 0;
  std::string key;  // "can.accelerometer.x"
};

struct SignalReference {
  const DbcMessage* message = nullptr;
  std::vector<const DbcSignal*> signals;  // in the order of their numbers; never empty
};

// The result points into `dbc`. Throws InputError at `where`: not of either form, or not in the DBC file; it then names
// the nearest names that are.
SignalReference find_signals(const Dbc& dbc, const std::string& reference, const CellKey& where);

}  // namespace stillcut
