"""Particle filters: the effective number of particles."""
import math

import common

particles = common.rows("particles.csv")


def effective(column):
    logs = [row[column] for row in particles]
    most = max(logs)
    weights = [math.exp(l - most) for l in logs]
    total = sum(weights)
    return 1 / sum((w / total) ** 2 for w in weights)


number = effective("log_likelihood")
logs = [row["log_likelihood"] for row in particles]
weights = [math.exp(l - max(logs)) for l in logs]
common.answer(
    number,
    underflow="nan",
    few_beams=effective("log_likelihood_few_beams"),
    all_particles=len(particles),
    share=number / len(particles),
    inverse=1 / number,
    logarithms=sum(logs) ** 2 / sum(l * l for l in logs),
    largest=sum(weights),
    sign=-number,
)
