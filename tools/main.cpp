// The `supple` program.
#include "tools/console/program.h"

int main(int argc, char** argv) {
  using namespace supple::tools;
  return run_program(
      argc, argv,
      {"Supple deforms CT and MRI volumes and shows them.",
       "Examples:\n"
       "  supple info head.nii.gz\n"
       "  supple deform head.nhdr --material ct.toml --grab 128,211,12 --by 0,12,0 -o drag.vdb\n"
       "  supple render drag.vdb --preset Bone -o drag.png\n"
       "Exit codes: 0 done, 1 failure or over a limit, 2 wrong command line or existing output,\n"
       "3 unusable value or file, 4 the system refuses (disk, permission, memory).",
       {add_info,       add_probe,         add_convert,   add_compose,  add_fit,      add_crop,
        add_straighten, add_smooth,        add_threshold, add_deform,   add_render,   add_slice,
        add_presets,    add_keys,          add_export,    add_resample, add_apply,    add_augment,
        add_run,        add_sweep,         add_cohort,    add_replay,   add_compare,  add_invert,
        add_metrics,    add_modes,         add_mesh,      add_view,     add_tradeoff, add_stress,
        add_bench,      add_slicer_module, add_help}});
}
