//! The paper's Table 1, as printed.

/// Mean and standard deviation of the absolute disparity error of one scene, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Printed {
    /// Column "Avg."
    pub(crate) mean: f64,
    /// Column "Std. dev."
    pub(crate) std: f64,
}

/// The scenes of the table, in its order.
pub(crate) const SCENES: [&str; 3] = ["venus", "sawtooth", "tsukuba"];

/// The rows of the table, in its order: the filters' name and one entry a scene.
pub(crate) const ROWS: [(&str, [Printed; 3]); 5] = [
    ("Gabor", printed([0.25, 0.77, 0.41, 1.26, 0.32, 0.61])),
    ("s4", printed([0.40, 1.30, 0.50, 1.86, 0.36, 0.68])),
    ("s2", printed([0.98, 2.44, 1.12, 2.50, 0.47, 0.79])),
    ("SQF", printed([0.95, 2.40, 0.93, 2.20, 0.46, 0.85])),
    (
        "PBBDE 2D shift",
        printed([0.04, 0.74, 0.57, 1.08, 0.12, 0.67]),
    ),
];

/// How the table is to be read, in a sentence or two.
pub(crate) const READING: &str = "\
The paper does not say over which pixels its errors are taken; its first four rows look like a \
mean absolute error over textured, valid pixels, so that is what stands below them. Its last row \
mixes a signed mean with a standard deviation: a mean absolute error of 0.04 px on Venus is below \
what a truth rounded to 1/8 px allows.";

const fn printed(row: [f64; 6]) -> [Printed; 3] {
    let [
        venus,
        venus_std,
        sawtooth,
        sawtooth_std,
        tsukuba,
        tsukuba_std,
    ] = row;
    [
        Printed {
            mean: venus,
            std: venus_std,
        },
        Printed {
            mean: sawtooth,
            std: sawtooth_std,
        },
        Printed {
            mean: tsukuba,
            std: tsukuba_std,
        },
    ]
}
