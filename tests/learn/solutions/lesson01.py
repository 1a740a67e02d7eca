"""A lidar in a raster: the mean of the readings that were not lost."""
import common

readings = [row["range_m"] for row in common.rows("ahead.csv")]
seen = [r for r in readings if r > 0]
mean = sum(seen) / len(seen)
common.answer(
    mean,
    cells=mean / 0.05,
    centimetres=100 * mean,
    lost_readings=sum(readings) / len(readings),
    shortest=min(seen),
    longest=max(seen),
    sign=-mean,
)
