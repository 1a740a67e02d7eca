# awk -v program=NAME -v x=FIELD -v y=FIELD -v yaw=FIELD -f frames_to_tum.awk SCANS PATH: a path of MRPT's programs, which count
# frames, as a TUM trajectory with the stamps of the scans. They pass over a first frame that no action stands before; a
# frame of comments may follow the last scan.
FNR == NR { stamp[FNR] = $1; scans = FNR; next }
{ px[FNR] = $x; py[FNR] = $y; half[FNR] = $yaw / 2; poses = FNR }
END {
  if (poses < scans - 1 || poses > scans + 1) {
    print program " wrote " poses + 0 " poses for " scans " scans" > "/dev/stderr"
    exit 1
  }
  skipped = poses < scans
  for (i = 1; i <= poses && i + skipped <= scans; ++i)
    printf "%s %.9f %.9f 0 0 0 %.9f %.9f\n", stamp[i + skipped], px[i], py[i], sin(half[i]), cos(half[i])
}
