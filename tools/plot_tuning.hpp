// The picture of `stillcut tune`: what each alarm limit finds against how often it is wrong, and how late it is.
#pragma once

#include "tools/plot.hpp"
#include "tools/tuning_report.hpp"

namespace stillcut {

plot::Figure tuning_figure(const TuningResult& result);

}  // namespace stillcut
