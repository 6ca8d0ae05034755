#include "common/plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace brume {
namespace {

constexpr double kWidth = 760, kHeight = 460, kLeft = 70, kRight = 20, kTop = 40, kBottom = 50;
constexpr size_t kCrowded = 100; // points, above which they are small
constexpr const char* kColours[] = {"#1f6fb4", "#d9702a", "#2f9e58", "#a04fb5", "#b8434e", "#6b6f76"};

std::string format(const char* how, auto... values) {
    char text[512];
    std::snprintf(text, sizeof text, how, values...);
    return text;
}

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
    return out;
}

// A logarithmic axis over whole decades or, when all values are near, over 1-2-5 steps. A linear one has up to ten such
// steps.
struct Axis {
    double lo, hi, begin, end; // lo ... hi is drawn from begin to end
    bool linear = false;
    double at(double v) const {
        return begin + (end - begin) * (linear ? (v - lo) / (hi - lo) : std::log(v / lo) / std::log(hi / lo));
    }

    std::vector<double> ticks() const {
        std::vector<double> all;
        if (linear) {
            double step = std::pow(10, std::floor(std::log10((hi - lo) / 10)));
            for (int i = 0; (hi - lo) / step > 10; ++i) step *= i % 3 == 1 ? 2.5 : 2;
            for (double tick = std::ceil(lo / step); tick * step <= hi; ++tick) all.push_back(tick * step);
            return all;
        }
        for (double decade = std::pow(10, std::floor(std::log10(lo))); decade <= hi * 1.001; decade *= 10)
            for (const double step : {1.0, 2.0, 5.0})
                if (decade * step >= lo * 0.999 && decade * step <= hi * 1.001 && (step == 1.0 || hi / lo < 200))
                    all.push_back(decade * step);
        return all;
    }
};

Axis axisOver(const std::vector<Point>& points, double Point::*value, double begin, double end, bool linear = false) {
    double lo = 1e300, hi = -1e300;
    for (const Point& p : points) lo = std::min(lo, p.*value), hi = std::max(hi, p.*value);
    if (linear) return {lo, hi > lo ? hi : lo + 1, begin, end, true};
    return {lo / 1.35, hi * 1.35, begin, end};
}

// True: the point has bounds that a logarithmic axis can show.
bool hasBar(const Point& p) { return p.low > 0 && p.high >= p.low && std::isfinite(p.high); }

// The points, and two for each bar at its ends.
std::vector<Point> withBounds(std::vector<Point> points) {
    for (size_t i = 0, count = points.size(); i < count; ++i) {
        if (!hasBar(points[i])) continue;
        for (const double end : {points[i].low, points[i].high}) points.push_back({"", points[i].x, end});
    }
    return points;
}

struct Box {
    double x, y, width, height;
    bool meets(const Box& o) const {
        return x < o.x + o.width && o.x < x + width && y < o.y + o.height && o.y < y + height;
    }
};

// Where a label of this width stands beside its point: the first place that meets nothing, nearest first.
Box placed(double x, double y, double width, const std::vector<Box>& taken) {
    Box first{};
    for (int ring = 0; ring < 8; ++ring)
        for (const double side : {8.0, -8 - width})
            for (const double up : {-16.0 - 14 * ring, 2.0 + 14 * ring}) {
                const Box at{x + side, y + up, width, 14};
                if (ring == 0 && first.width == 0) first = at;
                const bool inside =
                    at.x > kLeft && at.x + width < kWidth && at.y > kTop && at.y + 14 < kHeight - kBottom;
                if (inside &&
                    std::none_of(taken.begin(), taken.end(), [&](const Box& other) { return at.meets(other); }))
                    return at;
            }
    return first;
}

} // namespace

std::vector<size_t> paretoFront(const std::vector<Point>& points) {
    std::vector<size_t> order(points.size()), front;
    for (size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
        return points[a].x != points[b].x ? points[a].x < points[b].x : points[a].y < points[b].y;
    });
    for (const size_t i : order)
        if (front.empty() || points[i].y < points[front.back()].y) front.push_back(i);
    return front;
}

std::string svg(const Plot& plot) {
    std::vector<Point> points;
    for (const Point& p : plot.points)
        if (std::isfinite(p.x) && std::isfinite(p.y) && (plot.linear_x || p.x > 0) && p.y > 0) points.push_back(p);
    std::string out = format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %g %g\" font-family=\"sans-serif\" font-size=\"12\">\n"
        "<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n",
        kWidth, kHeight);
    out += format("<text x=\"%g\" y=\"22\" font-size=\"15\">", kLeft) + escaped(plot.title) + "</text>\n";
    if (points.empty()) return out + "</svg>\n";
    const Axis x = axisOver(points, &Point::x, kLeft, kWidth - kRight, plot.linear_x),
               y = axisOver(withBounds(points), &Point::y, kHeight - kBottom, kTop);
    for (const double v : x.ticks())
        out += format(
            "<path d=\"M%.1f %gV%g\" stroke=\"#e4e6ea\"/><text x=\"%.1f\" y=\"%g\" text-anchor=\"middle\">%g</text>\n",
            x.at(v), kTop, kHeight - kBottom, x.at(v), kHeight - kBottom + 16, v);
    for (const double v : y.ticks())
        out += format(
            "<path d=\"M%g %.1fH%g\" stroke=\"#e4e6ea\"/><text x=\"%g\" y=\"%.1f\" text-anchor=\"end\">%g</text>\n",
            kLeft, y.at(v), kWidth - kRight, kLeft - 6, y.at(v) + 4, v);
    out += format("<text x=\"%g\" y=\"%g\" text-anchor=\"middle\">", (kLeft + kWidth) / 2, kHeight - 12) +
           escaped(plot.x_label) + "</text>\n";
    out += format("<text transform=\"translate(16 %g) rotate(-90)\" text-anchor=\"middle\">", kHeight / 2) +
           escaped(plot.y_label) + "</text>\n";

    const auto line = [&](const std::vector<size_t>& along, const char* colour) {
        std::string path;
        for (const size_t i : along)
            path += format("%s%.1f %.1f", path.empty() ? "M" : "L", x.at(points[i].x), y.at(points[i].y));
        out += "<path d=\"" + path + "\" fill=\"none\" stroke=\"" + colour + "\" stroke-width=\"1.5\"/>\n";
    };
    const std::vector<size_t> front = plot.front ? paretoFront(points) : std::vector<size_t>{};
    if (plot.front) line(front, "#2b2f36");
    if (plot.joined) {
        for (int group = 0; group < 6; ++group) {
            std::vector<size_t> along;
            for (size_t i = 0; i < points.size(); ++i)
                if (points[i].group % 6 == group) along.push_back(i);
            if (along.size() > 1) line(along, kColours[group]);
        }
    }
    const int radius = points.size() > kCrowded ? 2 : 4;
    std::vector<Box> taken;
    for (const Point& p : points) taken.push_back({x.at(p.x) - 6, y.at(p.y) - 6, 12, 12});
    for (size_t i = 0; i < points.size(); ++i) {
        const Point& p = points[i];
        const bool best = std::find(front.begin(), front.end(), i) != front.end();
        if (hasBar(p))
            out += format("<path d=\"M%.1f %.1fV%.1f\" stroke=\"%s\" stroke-opacity=\"0.4\"/>", x.at(p.x), y.at(p.low),
                          y.at(p.high), kColours[p.group % 6]);
        out += format("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%d\" fill=\"%s\"%s/>", x.at(p.x), y.at(p.y),
                      best ? 6 : radius, kColours[p.group % 6], best ? " stroke=\"#2b2f36\" stroke-width=\"1.5\"" : "");
        if (p.label.empty()) {
            out += '\n';
            continue;
        }
        const Box at = placed(x.at(p.x), y.at(p.y), 6.6 * double(p.label.size()), taken);
        taken.push_back(at);
        const char* const colour = plot.joined ? kColours[p.group % 6] : "#000"; // a label may be of a whole line
        out += format("<text x=\"%.1f\" y=\"%.1f\" fill=\"%s\"%s>", at.x, at.y + 11, colour,
                      best ? " font-weight=\"bold\"" : "") +
               escaped(p.label) + "</text>\n";
    }
    return out + "</svg>\n";
}

} // namespace brume
