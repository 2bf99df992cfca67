//! What stands below the options of each command: two examples, and what else there is to know.

use crate::grade::RULE;

pub(super) const PROGRAM: &str = "\
Examples:
  trueray scene.txt
  trueray render scene.txt -o scene.png

Exit codes: 0 ok, 2 usage, 3 scene, 4 no device, 5 device lost, 6 output, 7 no thread; 75 SIGTERM ended a render; \
128 + n where signal n ended the run. merge: 1 parts are missing. compare: 0 same, 1 different, 2 trouble; grade: 1 some picture is not right; verify: 0 right, 1 wrong, 2 trouble. stress: 1 a promise is broken; conform: 1 a driver is wrong.

Environment: WGPU_ADAPTER_NAME, WGPU_POWER_PREF, WGPU_BACKEND, VK_DRIVER_FILES are honoured; \
TRUERAY_NO_TUNING=1 ignores what `bench --tune` has kept, TRUERAY_KERNEL_CACHE=0 the kernels that \
earlier runs have compiled; TRUERAY_PATIENCE=S gives a device up that has not answered for S seconds (120).";

pub(super) const RENDER: &str = "\
Examples:
  trueray render scene.txt -o scene.png
  trueray render --convention exact --spp 16 --res 1920x1080 --stats scene.txt -o large.png

A name that ends in .exr or .pfm gets colours that are neither clamped nor quantised; --bits 16 is for PNG.";

pub(super) const MERGE: &str = "\
Examples:
  trueray merge part-*.png -o scene.png
  trueray merge left.ppm right.ppm -o scene.ppm

`trueray render --tile 0/4 scene.txt -o part-0.png` and so on to 3/4 render the parts; farm/ has templates for job schedulers.

Exit codes: 0 ok, 1 parts are missing, 2 they do not fit together or are damaged, 6 output.";

pub(super) const COMPARE: &str = "\
Examples:
  trueray compare --scene scene.txt mine.ppm
  trueray compare mine.ppm theirs.png --heatmap difference.png";

pub(super) const VERIFY: &str = "\
Examples:
  trueray verify scene.png --scene scene.txt
  trueray verify --convention exact scene.png --scene scene.txt --certificate scene.json

The options that decide the picture must be those of the picture. `trueray compare --scene` says of a picture that \
another renderer made which pixels rounding explains; here rounding explains nothing.

Exit codes: 0 right, 1 wrong or another picture's certificate, 2 trouble.";

pub(super) const PIXEL: &str = "\
Examples:
  trueray pixel scene.txt 320 240
  trueray pixel --convention exact --device cpu --json scene.txt 0 17

Numbers are in the units of the file. Margins say how far each decision is from being taken otherwise: a renderer whose \
rounding errors come to as much shows another pixel.";

pub(super) const CHECK: &str = "\
Examples:
  trueray check scenes/effects/*.txt
  trueray check --json --convention exact scene.txt";

pub(super) const STUDY: &str = "\
Examples:
  trueray study scene.txt --report study.html
  trueray study --spp-list 1,4 --depths 0,1,2 --hard-cases 0 scene.txt --csv points.csv";

pub(super) const STRESS: &str = "\
Examples:
  trueray stress
  trueray stress --class far,secondary --precision robust --json

Each kernel is checked against double-double truth for the very numbers that it got, and judged by what its \
tier promises. schoolbook (judged as fast) and no-barrier (judged as robust) are what goes wrong without care; \
they run only when asked for by name, and then count like the others.

Exit codes: 0 every promise holds, 1 one is broken on this device, 2 usage, 4 no device or none that has the \
kernel, 5 device lost.";

pub(super) const CONFORM: &str = "\
Examples:
  trueray conform --json today.json --junit conform.xml --baseline known.json
  trueray conform --diff lavapipe.json swiftshader.json

What --json has written is a baseline: its flaws are known. They must still be flaws, and no others may be. To take them from one \
device to another, or by hand, keep of `checks` what is to be known.

Exit codes: 0 all is right or a known flaw; with --diff nothing differs by more than rounding explains, 1 a pixel is unexplained, a \
promise is broken or a known flaw is none any more, 2 usage, 4 no device or none that renders anything, 5 device lost.";

pub(super) const BENCH: &str = "\
Examples:
  trueray bench --families spheres --max-spheres 10000 --report bench.html
  trueray bench --tune";

pub(super) const IMPORT: &str = "\
Examples:
  trueray import protein.pdb -o scene.txt
  trueray import --frame 1-50 --color-by vz:coolwarm dump.lammpstrj -o scene_%04d.txt

A file is told by what it begins with, not by its name. render, view, check and export take the same files and options. Camera, \
range of colours and substitute radii are those of the first frame that is read.";

pub(super) const EXPORT: &str = "\
Examples:
  trueray export scene.txt --to povray -o scene.pov
  trueray export --convention exact --res 640x480 scene.txt --to tachyon";

#[cfg(feature = "view")]
pub(super) const VIEW: &str = "\
Examples:
  trueray view scene.txt
  trueray view --convention exact --precision fast --listen 127.0.0.1:8080 scene.txt";

pub(super) const DEVICES: &str = "\
Examples:
  trueray devices
  trueray devices --json";

pub(super) const COMPLETIONS: &str = "\
Examples:
  trueray completions bash > ~/.local/share/bash-completion/completions/trueray
  trueray completions fish > ~/.config/fish/completions/trueray.fish";

pub(super) const MAN: &str = "\
Examples:
  trueray man > trueray.1
  trueray man render > trueray-render.1";

pub(super) const SHADER: &str = "\
Examples:
  trueray shader scene.txt
  trueray shader --precision robust --spirv scene.txt > kernel.spvasm";

pub(super) fn grade() -> String {
    format!(
        "\
Examples:
  trueray grade --scenes scenes --theirs pictures --html grades.html --csv grades.csv
  trueray grade --scenes scenes --theirs students --no-explain --json grades.json

Score: {RULE}

Exit codes: 0 every picture has the full score, 1 some have not, 2 usage, 3 scene, 4 no device, 6 output."
    )
}
