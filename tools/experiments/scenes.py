# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""The experiments: which images arrive in which orders, and what the paper reports of the like."""
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Photographs:
    """A folder of docs/datasets.md; paths are relative to $PSFM_DATASETS."""
    name: str
    images: str
    reference: str | None = None


@dataclass(frozen=True)
class Simulation:
    """Correspondences that `psfm simulate` makes."""
    name: str
    options: tuple


@dataclass(frozen=True)
class Run:
    """One order of arrival. `order`: ("names",), ("shuffle", SEED), ("sample", COUNT, SEED) for a random part in
    file-name order, or ("file", PATH), where a simulation's own order.txt is ("file", "order.txt")."""
    name: str
    source: Photographs | Simulation
    order: tuple
    words: str
    batch: bool = False  # all images at once


@dataclass(frozen=True)
class Experiment:
    name: str
    title: str
    about: str
    runs: tuple
    # What the paper reports, by the keys of measurements.MILESTONES.
    paper: dict = field(default_factory=dict)
    runs_words: str = ""  # for --list, where the runs are many

    def words(self):
        return self.runs_words or "; ".join(run.words for run in self.runs)


TEMPLE = Photographs("temple-341", "temple-341/images", "temple-341/gt")
QUAD = Photographs("quad-streams", "quad-streams/images", "quad-streams/gt")
BOOKS = Photographs("books", "duplicates/books/images", "duplicates/books/reference")
CEREAL = Photographs("cereal", "duplicates/cereal/images", "duplicates/cereal/reference")
STREET = Photographs("street", "duplicates/street/images", "duplicates/street/reference")
# Strecha's photographs with laser-scanned truth: of tools/bench.
FOUNTAIN, HERZ_JESUS, ENTRY, CASTLE = (
    Photographs(name, f"strecha-half/{name}/images", f"strecha-half/{name}/gt")
    for name in ("fountain-P11", "Herz-Jesus-P8", "entry-P10", "castle-P19"))
SCEAUX = Photographs("sceaux", "sceaux/images")
KERMIT = Photographs("kermit", "kermit/images")
LUND = Photographs("lund", "lund/images")
# What people have: no poses are known, but `centres.txt` of some.
KITCHEN, BANANA, BRIGHTON, IONIQ5, MULTICAM = (
    Photographs(name, f"real/{name}/images") for name in ("kitchen", "banana", "brighton", "ioniq5", "multicam"))


def _shuffles(source):
    return tuple(Run(f"shuffle-{seed}", source, ("shuffle", seed), f"shuffled, seed {seed}") for seed in (1, 2, 3))


def _simulated():
    """Other symmetries than the photographs' six, other seeds, both kinds of trouble."""
    runs = []
    for symmetry, seed in ((4, 11), (6, 12), (9, 13)):
        temple = Simulation(f"temple-{symmetry}-sides", ("--scene", "temple", "--symmetry", str(symmetry),
                                                         "--seed", str(seed)))
        runs.append(Run(f"sides-{symmetry}-unfortunate", temple, ("file", "order.txt"),
                        f"{symmetry} sides, each image followed by its look-alike"))
        runs.append(Run(f"sides-{symmetry}-shuffle-{seed}", temple, ("shuffle", seed),
                        f"{symmetry} sides, shuffled, seed {seed}"))
    court = Simulation("courtyard", ("--scene", "courtyard", "--seed", "14"))
    runs.append(Run("courtyard-streams", court, ("file", "order.txt"), "courtyard, eight users at once"))
    return tuple(runs)


def _orders_of(source):
    """As the promise is asked of a scene: ten shuffles of the street, which has ended differently before."""
    shuffles = range(1, 11 if source is STREET else 6)
    return (Run("names", source, ("names",), "file-name order"),
            Run("batch", source, ("names",), "all at once", batch=True),
            *(Run(f"shuffle-{seed}", source, ("shuffle", seed), f"shuffled, seed {seed}") for seed in shuffles))


ORDERS = Experiment(
    "orders", "The promise as a table",
    "Whatever the order in which photographs arrive, a session ends with the same of them placed, in as many parts, "
    "and none of them wrong. Real scenes, three of them with look-alikes, in file-name order, all at once (`--batch`) "
    "and shuffled, each in deterministic and in default mode; the street in default mode three times, and in both with "
    "one camera for all of it.",
    tuple(run for source in (STREET, BOOKS, CEREAL, FOUNTAIN, HERZ_JESUS, ENTRY, CASTLE, SCEAUX, KERMIT, KITCHEN,
                             BANANA, BRIGHTON, IONIQ5, MULTICAM) for run in _orders_of(source)),
    runs_words="scene x order x mode (--scenes, --orders, --modes): placed, outliers, parts")


def _subsets_of(source):
    return tuple(Run(f"{count}-{seed}", source, ("sample", count, seed), f"{count} photographs, seed {seed}")
                 for count in (8, 11, 14) for seed in range(1, 7))


SUBSETS = Experiment(
    "subsets", "Few photographs of two alike things",
    "Where there are few photographs of two things that look alike, often nothing in them tells the two apart. Then a "
    "model may be wrong, whoever makes it, but psfm has to say at least that it is doubtful. Measured are random parts "
    "of three scenes with look-alikes, six each of 8, 11 and 14 photographs, in default mode: how many images psfm "
    "places, how many of them stand wrong, and whether it says so.",
    tuple(run for source in (STREET, BOOKS, CEREAL) for run in _subsets_of(source)),
    runs_words="scene x number of photographs x seed (--scenes): placed, wrong, parts, and whether psfm says it")


EXPERIMENTS = (
    Experiment(
        "temple-linear", "The temple in file-name order",
        "341 rendered images of a round temple with six equal sides, taken on one ring and arriving in the order "
        "of the ring (`temple-341`). The easy case: each image is followed by its neighbour. The paper's own "
        "scene is TempleOfHeaven, of as many images.",
        (Run("linear", TEMPLE, ("names",), "file-name order"),),
        {"most_outliers": 8}),
    Experiment(
        "temple-shuffled", "The temple in random orders",
        "The same 341 images, shuffled. While the ring is sparse, look-alikes a sixth of a turn away have more "
        "matches than neighbours, and a reconstruction that believes them stays folded.",
        _shuffles(TEMPLE), {"nearly_all_right": 84}),
    Experiment(
        "temple-unfortunate", "The temple in a very unfortunate order",
        "The same 341 images as I0, I57, I1, I58, …: each followed by its look-alike a sixth of a turn further on "
        "(`unfortunate_order.txt`). The first images speak for a wrong model; later ones expose it.",
        (Run("unfortunate", TEMPLE, ("file", "temple-341/unfortunate_order.txt"),
             "each image followed by its look-alike"),),
        {"no_outlier_and_placed": 36, "one_effective": 95, "one_cluster": 101}),
    Experiment(
        "quad-streams", "Eight users in a courtyard",
        "600 rendered images of a courtyard with two arcades that repeat, taken by eight users with three cameras "
        "and arriving as they were taken (`streams_order.txt`).",
        (Run("streams", QUAD, ("file", "quad-streams/streams_order.txt"), "as taken by eight users"),)),
    Experiment(
        "books", "Two copies of a book on one shelf",
        "21 photographs of a shelf with two copies of the same book at its ends, shuffled. The reference is a "
        "reconstruction by COLMAP 3.8 with matching restricted to neighbours in file-name order.",
        _shuffles(BOOKS)),
    Experiment(
        "cereal", "Two equal boxes and two equal mugs",
        "25 photographs of a table with two equal boxes and two equal mugs, shuffled. The reference is a "
        "reconstruction by COLMAP 3.8 with matching restricted to neighbours in file-name order.",
        _shuffles(CEREAL)),
    Experiment(
        "simulated", "Simulated temples with other symmetries, and a courtyard",
        "Correspondences from `psfm simulate`, with known truth: temples of 341 images with four, six and nine "
        "equal sides, each in two orders, and a courtyard of 600 images.",
        _simulated()),
    ORDERS,
    SUBSETS,
)


def experiment_of(name):
    return next((experiment for experiment in EXPERIMENTS if experiment.name == name), None)
