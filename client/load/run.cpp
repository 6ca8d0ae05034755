#include "client/load/run.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "client/native/statistics.h"

namespace brume::load {

uint64_t Run::allFrames() const { return std::accumulate(frames.begin(), frames.end(), uint64_t(0)); }

double Run::leastFps() const { return double(*std::min_element(frames.begin(), frames.end())) / seconds; }

double Run::medianFps() const {
    const std::vector<float> values(frames.begin(), frames.end());
    return double(client::percentile(values, 0.5).value_or(NAN)) / seconds;
}

double Run::mostFps() const { return double(*std::max_element(frames.begin(), frames.end())) / seconds; }

double Run::ageMs(double fraction) const { return double(client::percentile(ages_ms, fraction).value_or(NAN)); }

double Run::errorMeasured(double fraction) const {
    return double(client::percentile(errors_measured, fraction).value_or(NAN));
}

double Run::awayMs(double fraction) const {
    std::vector<float> values;
    for (const Return& back : returns) values.push_back(float(double(back.back_us - back.lost_us) * 1e-3));
    return double(client::percentile(std::move(values), fraction).value_or(NAN));
}

double Run::commandP95Ms() const {
    double most = NAN;
    for (const ServerRun& one : servers)
        most = std::fmax(most, one.command_p95_ms); // fmax takes the number where the other is NaN
    return most;
}

double ServerRun::pictureMs(double fraction) const {
    return double(client::percentile(picture_ms, fraction).value_or(NAN));
}

double Run::latencyMs(double fraction) const {
    return double(client::percentile(latencies_ms, fraction).value_or(NAN));
}

} // namespace brume::load
