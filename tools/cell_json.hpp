// What the page is sent, as JSON: field names and units of docs/scope.md ("What is sent"). Times are seconds since
// `origin_ns`; what is unknown or not applicable is null.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "tools/cell_view.hpp"

namespace stillcut {

// time_ns: of the state, on the clock of origin_ns.
nlohmann::ordered_json state_json(const CellView& view, const ShownState& state, std::int64_t time_ns,
                                  std::int64_t origin_ns);
nlohmann::ordered_json spectrum_json(const SpectrumReport& report, std::int64_t origin_ns);
nlohmann::ordered_json lobes_json(const DiagramReport& report, std::int64_t origin_ns);
nlohmann::ordered_json event_json(const Event& event, std::int64_t origin_ns);
nlohmann::ordered_json correction_json(const Correction& correction, std::int64_t origin_ns);
nlohmann::ordered_json health_json(const HealthReport& report, std::int64_t origin_ns);
// histogram: nullptr: none was heard.
nlohmann::ordered_json latency_json(const LatencyReport& report, const HistogramReport* histogram,
                                    std::int64_t origin_ns);

// The hops of a sample's and a message's way, with what each lost: "CAN, dropped by the kernel", ...
struct Hop {
  const char* name;    // for people
  const char* metric;  // for Prometheus: "kernel"
  std::int64_t lost;
};
std::vector<Hop> hops_of(const HealthReport& report);

}  // namespace stillcut
