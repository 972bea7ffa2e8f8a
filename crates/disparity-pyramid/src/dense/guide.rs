use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use crate::dense::EyeView;
use crate::dense::nearest::place;
use crate::dense::noise_level::noise_level;

/// The picture that says where surfaces end: one channel or three, 8 bits each, channel by channel.
#[derive(Clone, Debug, Default)]
pub(crate) struct Guide {
    width: usize,
    height: usize,
    /// Planes in row-major order, one a channel.
    channels: Vec<Vec<u8>>,
    /// How far each pixel's colour lies from the next one's on its row, and from the one below, in
    /// steps of 8 bits; 0 where there is none.
    beside: Vec<u8>,
    below: Vec<u8>,
    /// Room for the noise of blocks, and for a plane on its way to a smoother one.
    noise: Vec<f32>,
    rows: Vec<u8>,
}

/// A row of lumas in 256 steps from 0 to 1.
struct Greys<'a> {
    luma: &'a [f32],
    plane: &'a mut [u8],
}

impl NullaryFnOnce for Greys<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (grey, luma) in self.plane.iter_mut().zip(self.luma) {
            *grey = place((luma * 255.0).clamp(0.0, 255.0)) as u8;
        }
    }
}

impl Guide {
    /// Takes in the colours of a view, or its luma in 256 steps from 0 to 1 if it has none or they are
    /// not asked for. From a noise of `noisy` on, in parts of the whole range, they are smoothed first: a step
    /// of noise is no end of a surface. Gives the noise's standard deviation then.
    pub(crate) fn take_in(&mut self, view: &EyeView<'_>, colour: bool, noisy: f32) -> Option<f32> {
        let size = view.luma.size();
        (self.width, self.height) = (size.width, size.height);
        match view.rgb.filter(|_| colour) {
            Some(rgb) => {
                self.channels.resize_with(3, Vec::new);
                for (channel, plane) in self.channels.iter_mut().enumerate() {
                    plane.clear();
                    plane.extend(rgb.iter().map(|colour| colour[channel]));
                }
            }
            None => {
                let rows = view.luma.plane();
                let Some(luma) = rows.to_slice() else {
                    unreachable!("a picture is kept in row-major order")
                };
                self.channels.resize_with(1, Vec::new);
                let plane = &mut self.channels[0];
                plane.resize(luma.len(), 0);
                plane
                    .par_chunks_mut(size.width)
                    .zip(luma.par_chunks(size.width))
                    .for_each(|(plane, luma)| Arch::new().dispatch(Greys { luma, plane }));
            }
        }
        // The noise of colours is about that of one of them.
        let noise = (noisy < 1.0)
            .then(|| noise_level(&self.channels[0], self.width, &mut self.noise) / 255.0)
            .filter(|noise| *noise >= noisy);
        if noise.is_some() {
            for plane in &mut self.channels {
                soften(plane, self.width, &mut self.rows);
            }
        }
        self.take_steps();
        noise
    }

    /// The steps of colours that are there.
    fn take_steps(&mut self) {
        let area = self.width * self.height;
        steps(&self.channels, 1, &mut self.beside);
        self.beside.resize(area, 0);
        // The last pixel of a row has no next one.
        for last in self
            .beside
            .chunks_mut(self.width)
            .filter_map(<[u8]>::last_mut)
        {
            *last = 0;
        }
        steps(&self.channels, self.width, &mut self.below);
        self.below.resize(area, 0);
    }

    /// Exchanges left and right.
    pub(crate) fn mirror(&mut self) {
        for plane in &mut self.channels {
            plane.chunks_mut(self.width).for_each(<[u8]>::reverse);
        }
        self.take_steps();
    }

    pub(crate) const fn width(&self) -> usize {
        self.width
    }

    pub(crate) const fn height(&self) -> usize {
        self.height
    }

    /// How many channels there are.
    pub(crate) const fn channels(&self) -> usize {
        self.channels.len()
    }

    /// One channel, row-major.
    pub(crate) fn plane(&self, channel: usize) -> &[u8] {
        &self.channels[channel]
    }

    /// How far two pixels' colours lie apart, in steps of 8 bits: the mean over the channels, which
    /// the noise of one does not carry.
    #[cfg(test)]
    pub(crate) fn step(&self, one: usize, other: usize) -> u8 {
        let step = |plane: &Vec<u8>| u16::from(plane[one].abs_diff(plane[other]));
        let sum: u16 = self.channels.iter().map(step).sum();
        (sum / self.channels.len() as u16) as u8
    }

    /// The steps from each pixel of a row to the next one.
    #[inline(always)]
    pub(crate) fn beside(&self, y: usize) -> &[u8] {
        &self.beside[y * self.width..(y + 1) * self.width]
    }

    /// The steps from each pixel of a row to the one below.
    #[inline(always)]
    pub(crate) fn below(&self, y: usize) -> &[u8] {
        &self.below[y * self.width..(y + 1) * self.width]
    }
}

/// Smooths a plane by the binomial `[1 4 6 4 1] / 16` along rows and columns, whose standard deviation is a
/// pixel. Beyond the ends of a line its last value holds.
fn soften(plane: &mut [u8], width: usize, rows: &mut Vec<u8>) {
    const TAPS: [u16; 5] = [1, 4, 6, 4, 1];
    let height = plane.len() / width;
    let line = |at: usize, length: usize, value: &dyn Fn(usize) -> u8| {
        let sum: u16 = TAPS
            .iter()
            .enumerate()
            .map(|(tap, weight)| {
                weight * u16::from(value((at + tap).saturating_sub(2).min(length - 1)))
            })
            .sum();
        ((sum + 8) / 16) as u8
    };
    rows.resize(plane.len(), 0);
    for (row, out) in plane.chunks(width).zip(rows.chunks_mut(width)) {
        for (x, out) in out.iter_mut().enumerate() {
            *out = line(x, width, &|x| row[x]);
        }
    }
    for (y, out) in plane.chunks_mut(width).enumerate() {
        for (x, out) in out.iter_mut().enumerate() {
            *out = line(y, height, &|y| rows[y * width + x]);
        }
    }
}

/// How far each pixel's colour lies from that of the pixel `further` on, as long as there is one.
fn steps(channels: &[Vec<u8>], further: usize, steps: &mut Vec<u8>) {
    let pairs = |plane| {
        let plane: &[u8] = plane;
        plane.iter().zip(plane.get(further..).unwrap_or_default())
    };
    steps.clear();
    match channels {
        [grey] => steps.extend(pairs(grey).map(|(here, there)| here.abs_diff(*there))),
        [red, green, blue] => {
            let step = |(here, there): (&u8, &u8)| u16::from(here.abs_diff(*there));
            let others = pairs(green).zip(pairs(blue));
            let colours = pairs(red).zip(others);
            steps
                .extend(colours.map(|(red, (green, blue))| {
                    ((step(red) + step(green) + step(blue)) / 3) as u8
                }));
        }
        _ => {}
    }
}
