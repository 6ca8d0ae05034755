// Whether a row of measurements grows by more than they scatter, for soak.mjs.

const median = (values) => {
  const sorted = [...values].sort((a, b) => a - b);
  const middle = sorted.length >> 1;
  return sorted.length % 2 === 1 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
};

// { grows, drift, scatter }. drift: what the values have grown by from the first to the last, by the median of the
// slopes of all pairs (Theil-Sen), which a few wild ones do not move. scatter: of single values about that line, as a
// standard deviation. grows: the drift is above `floor`, and above four standard errors of the same from values that
// only scatter.
export function trend(values, floor = 0) {
  const slopes = [];
  for (let i = 0; i < values.length; ++i)
    for (let j = i + 1; j < values.length; ++j) slopes.push((values[j] - values[i]) / (j - i));
  const slope = median(slopes);
  const rest = values.map((value, i) => value - slope * i);
  const level = median(rest);
  const scatter = 1.4826 * median(rest.map((value) => Math.abs(value - level)));
  const drift = slope * (values.length - 1);
  const error = scatter * Math.sqrt(12 / values.length);
  return { grows: drift > floor && drift > 4 * error, drift, scatter };
}
