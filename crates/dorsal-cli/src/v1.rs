use std::io::Write;

use anyhow::Context as _;
use stereo_formats::picture;

use crate::console::Console;
use crate::outputs::{Outputs, ensure_folder};
use crate::report::{monogenic_page, responses_page};
use crate::times::Times;
use crate::v1_arguments::{Bank, V1Arguments};
use crate::v1_files::{congruency_files, monogenic_files, response_files};
use crate::v1_record::V1Record;

/// What noise alone adds up to over all scales, in units of luma: two and a half grey levels of 256.
const NOISE: f32 = 0.01;

/// `dorsal v1`: filters one picture and writes what is found.
pub(crate) fn v1(arguments: &V1Arguments, out: &mut dyn Write) -> anyhow::Result<()> {
    arguments.threads.install()?;
    ensure_folder(&arguments.out)?;
    let console = Console::new(arguments.quiet);
    let mut times = Times::default();

    console.step("reading the picture");
    let picture = times.measure("reading", || picture::read(&arguments.image))?;
    let size = picture.size();
    let bank = arguments
        .bank(size)
        .with_context(|| format!("{} cannot be filtered", arguments.image.display()))?;

    console.step("filtering");
    let mut record = V1Record::new(arguments, &bank, size);
    match &bank {
        Bank::Oriented(bank) => {
            let responses = times.measure("responses", || bank.respond(picture.luma()))?;
            console.step("finding edges");
            // One scale agrees with itself everywhere, so that nothing would be said.
            let congruency = (responses.scales().len() > 1)
                .then(|| times.measure("edges", || responses.phase_congruency(NOISE)));
            console.step("writing");
            let mut files = Outputs::default();
            for (scale, responses) in responses.scales().iter().enumerate() {
                response_files(&mut files, scale, responses);
            }
            if let Some(congruency) = &congruency {
                congruency_files(&mut files, congruency);
            }
            let (scales, so_far) = (responses.scales(), times.clone());
            let (picture, congruency) = (&picture, congruency.as_ref());
            files.add("index.html", move || {
                responses_page(picture, scales, congruency, &so_far)
            });
            record.write(files, times, arguments, &console, out)
        }
        Bank::Spherical(bank) => {
            let responses = times.measure("responses", || bank.respond(picture.luma()))?;
            console.step("writing");
            let mut files = Outputs::default();
            for (scale, planes) in responses.scales().iter().enumerate() {
                monogenic_files(&mut files, scale, planes);
            }
            let (scales, so_far, picture) = (responses.scales(), times.clone(), &picture);
            files.add("index.html", move || {
                monogenic_page(picture, scales, &so_far)
            });
            record.write(files, times, arguments, &console, out)
        }
    }
}
