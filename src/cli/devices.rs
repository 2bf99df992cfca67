//! `trueray devices`.

use super::failure::{Failure, OUTPUT};
use super::files::json;
use super::output::{errln, out, outln};
use crate::gpu::{DeviceTuning, Error, hidden, list};

/// Arguments of `trueray devices`.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Output")]
pub(super) struct Args {
    /// Print JSON, with everything that a report of a fault should tell
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let devices = list()?;
    let hidden = hidden();
    if args.json {
        // Those without an index cannot be chosen.
        let usable = devices.iter().map(serde_json::to_value);
        let all: Result<Vec<_>, _> = usable.chain(hidden.iter().map(serde_json::to_value)).collect();
        out!("{}", json(&all.map_err(|error| Failure::new(OUTPUT, error.to_string()))?)?);
    } else {
        const MIB: u64 = 1 << 20;
        for device in &devices {
            outln!("{}: {}", device.index, device.name);
            outln!("   type      {}", device.kind);
            outln!("   driver    {}", device.driver);
            if !device.pci.is_empty() {
                outln!("   PCI id    {}", device.pci);
            }
            outln!("   Vulkan    {}", device.vulkan);
            outln!("   f64       {}", if device.f64 { "yes" } else { "no" });
            outln!(
                "   limits    {} MiB a storage binding, {} MiB a buffer, {} workgroups a dispatch, {} invocations a workgroup, \
                 {} storage textures a kernel",
                device.max_storage_binding / MIB,
                device.max_buffer / MIB,
                device.max_workgroups,
                device.max_invocations,
                device.max_storage_textures
            );
            let tuned = DeviceTuning::of(device);
            if let Some(warning) = &tuned.warning {
                errln!("trueray: {warning}");
            }
            outln!("   tuning    {}", tuned.summary());
        }
        // Where there are no others, the error has them.
        for device in hidden.iter().filter(|_| !devices.is_empty()) {
            outln!("-: {device}");
        }
    }
    if devices.is_empty() {
        return Err(Error::none_found().into());
    }
    Ok(())
}
