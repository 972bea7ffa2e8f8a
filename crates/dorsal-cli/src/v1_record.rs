use std::io::Write;

use dorsal::v1_gabor::Size;
use serde::Serialize;

use crate::console::Console;
use crate::outputs::{FileName, Outputs};
use crate::times::Times;
use crate::v1_arguments::{Bank, FamilyName, V1Arguments};

/// What `v1.json` says of a picture's responses: schema `dorsal-v1/1`.
#[derive(Debug, Serialize)]
pub(crate) struct V1Record {
    schema: &'static str,
    version: &'static str,
    image: String,
    family: FamilyName,
    /// None for the spherical family, which finds one a pixel.
    orientations: Option<usize>,
    peak_frequency: f32,
    bandwidth_octaves: f32,
    /// None for the spherical family, which is made in the Fourier domain.
    taps: Option<usize>,
    /// The size of every scale, finest first.
    scales: Vec<ScaleRecord>,
    threads: usize,
    time_ms: Times,
    /// The files beside this one.
    files: Vec<FileName>,
}

#[derive(Debug, Serialize)]
struct ScaleRecord {
    width: usize,
    height: usize,
}

impl V1Record {
    pub(crate) fn new(arguments: &V1Arguments, bank: &Bank, size: Size) -> Self {
        let (gabor, scales, peak_frequency, bandwidth) = match bank {
            Bank::Oriented(bank) => {
                let params = bank.params();
                let bandwidth = params.bandwidth;
                (
                    Some(params),
                    params.scales,
                    params.peak_frequency,
                    bandwidth,
                )
            }
            Bank::Spherical(bank) => {
                let params = bank.params();
                (None, params.scales, params.peak_frequency, params.bandwidth)
            }
        };
        let sizes = std::iter::successors(Some(size), |size| Some(size.halved())).take(scales);
        Self {
            schema: "dorsal-v1/1",
            version: env!("CARGO_PKG_VERSION"),
            image: arguments.image.display().to_string(),
            family: arguments.family,
            orientations: gabor.map(|params| params.orientations),
            peak_frequency,
            bandwidth_octaves: bandwidth,
            taps: gabor.map(|params| params.taps()),
            scales: sizes
                .map(|Size { width, height }| ScaleRecord { width, height })
                .collect(),
            threads: rayon::current_num_threads(),
            time_ms: Times::default(),
            files: Vec::new(),
        }
    }

    /// Writes the files and this record beside them, and says so on `out`.
    pub(crate) fn write(
        &mut self,
        mut files: Outputs<'_>,
        mut times: Times,
        arguments: &V1Arguments,
        console: &Console,
        out: &mut dyn Write,
    ) -> anyhow::Result<()> {
        self.files = files.names();
        self.files.push("v1.json".into());
        self.time_ms = times.clone();
        let record = serde_json::to_vec_pretty(&self)?;
        files.add("v1.json", move || anyhow::Ok(record));
        times.measure("writing", || files.write(&arguments.out))?;
        console.clear();

        let coarsest = self.scales.last().map_or(0, |scale| scale.width);
        writeln!(
            out,
            "scales    {}, the coarsest {coarsest} pixels wide",
            self.scales.len()
        )?;
        writeln!(out, "time      {}", times.sentence())?;
        writeln!(
            out,
            "written   {} files in {}; v1.json lists them",
            self.files.len(),
            arguments.out.display()
        )?;
        Ok(())
    }
}
