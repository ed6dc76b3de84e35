#!/usr/bin/env python3
"""The study docs/studies/craniotomy.md in one command: its files, its tables, its diagrams.

  make.py [--supple PROGRAM] [--data FOLDER] [--anew] [PART ...]

Parts are prepare, tables, finite, shell, parts and pictures; all of them without. FOLDER has ch2bet.nii.gz, ch2.nii.gz, aal.nii.gz and
jhu189.nii.gz of Debian's mricron-data (build/data). Results of sweeps are kept in build/craniotomy, so that the
command goes on where it was ended; where the scene has changed, --anew drops them. `parts` needs numpy and nibabel (Debian: python3-nibabel), the others Python alone.
"""
import argparse
import csv
import glob
import os
import re
import shutil
import subprocess
import sys
import tomllib

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.normpath(os.path.join(HERE, "../../.."))
SCENE = os.path.join(HERE, "craniotomy.toml")
PAGE = os.path.join(HERE, "../craniotomy.md")
KPA_PER_MMHG = 0.1333224

# Calibrated: an angle per opening, and the thickness of the Dura.
OPENINGS = {"bi-frontal": ([0.0, -1.0, 0.4], 34.5),
            "lateral": ([1.0, 0.0, 0.3], 57.0),
            "lateral with temporal lobe": ([1.0, 0.0, 0.0], 62.8)}
DURA_MM = 0.78
PRESSURES_MMHG = [10, 40, 80]
POISSON, STIFFNESS_KPA = 0.47, 6.0

LABELS = {"left": 1, "right": 2, "cerebellum": 3, "core": 4, "ventricles": 5, "temporal_lobe": 6, "sylvian_bank": 7}
SEPTUM = [91, 120, 86]    # a voxel of ch2 between the frontal horns


def sheet(faces, between=None):
    where = f"between = {between}" if between else f'faces = "{faces}"'
    return f"{{ {where}, stiffness = 2500.0, poisson = 0.48, thickness = {DURA_MM} }}"


def swellings(mmhg, labels=()):
    """Of the parts of these labels, or of everything."""
    parts = [f"grab_label = {label}" for label in labels] or ["grab_density = [1, 255]"]
    return "[" + ", ".join(f"{{ pressure_kpa = {mmhg * KPA_PER_MMHG:.6f}, {part} }}" for part in parts) + "]"


def sheets(*all_of_them):
    return "[" + ", ".join(all_of_them) + "]"


def opening_keys(name):
    toward, degrees = OPENINGS[name]
    return {"step.tets.openings.toward": str(toward), "step.tets.openings.degrees": str(degrees)}


PARTS = ["prepare", "tables", "finite", "shell", "parts", "pictures"]


class Study:
    def __init__(self, options):
        self.supple, self.data = options.supple, options.data
        self.out = os.path.join(ROOT, "build/craniotomy")
        self.made = os.path.join(self.data, "craniotomy")
        for folder in (self.out, self.made):
            os.makedirs(folder, exist_ok=True)
        for old in glob.glob(os.path.join(self.out, "*.cases")) if options.anew else []:
            os.remove(old)

    def run(self, *args, good=(0,)):
        print("supple", " ".join(args), flush=True)
        status = subprocess.run([self.supple, *args], stdout=subprocess.DEVNULL).returncode
        if status not in good:
            sys.exit(status)

    def prepare(self):
        """The surface that the Dura covers: that of the mask, smoothed, so that it bridges the furrows."""
        at = lambda name: os.path.join(self.made, name)
        self.run("threshold", os.path.join(self.data, "ch2bet.nii.gz"), "--keep", "1,255", "--mask",
                 "--spacing", "1.005,1.005,1.005", "-o", at("mask.nii.gz"), "--force")
        self.run("smooth", at("mask.nii.gz"), "--sigma", "8", "-o", at("envelope.nii.gz"), "--force")
        self.run("mesh", at("envelope.nii.gz"), "--elements", "34000", "-o", at("brain.vtu"), "--force")

    def sweep(self, name, cases):
        """Runs the scene for each case, a table of keys, and returns the rows of results."""
        keys = list(dict.fromkeys(key for case in cases for key in case))
        path = os.path.join(self.out, name)
        with open(path + "_cases.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, keys, restval="")
            writer.writeheader()
            writer.writerows(cases)
        self.run("sweep", SCENE, "--cases", path + "_cases.csv", "-o", path + ".csv", "--force",
                 *(f"--collect={c}" for c in ("volume_ml=volume_change_ml", "mesh_ml", "smallest_det_f=fem.smallest_det_f")),
                 good=(0, 1))    # 1: a case failed; its row says so
        with open(path + ".csv", newline="") as file:
            rows = list(csv.DictReader(file))
        for row in rows:
            if row.get("error"):
                print(f"{name}: {row['error']}")
            row["percent"] = 100 * float(row["volume_ml"]) / float(row["mesh_ml"]) if row["volume_ml"] else None
        return rows


def left_mmhg(before, percent, poisson=POISSON, stiffness=STIFFNESS_KPA):
    """dV / V = -dp / K, K = E / 3 (1 - 2 nu)."""
    return before - percent / 100 * stiffness / (3 * (1 - 2 * poisson)) / KPA_PER_MMHG


def markdown(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def write_block(name, text):
    """Puts a table between its marks in the page."""
    with open(PAGE) as file:
        page = file.read()
    begin, end = f"<!-- made: {name} -->\n", "<!-- made -->"
    block = re.compile(re.escape(begin) + ".*?" + re.escape(end), re.S)
    if not block.search(page):
        sys.exit(f"{PAGE}: no place for {name}")
    with open(PAGE, "w") as file:
        file.write(block.sub(lambda _: begin + text + "\n" + end, page))


def table_6_3(study, thesis):
    cases = [{**opening_keys(name), "step.tets.swellings": swellings(p), "step.tets.sheets": dura}
             for name in OPENINGS for dura in (sheets(sheet("opening")), "") for p in PRESSURES_MMHG]
    rows = iter(study.sweep("table_6_3", cases))
    lines = []
    for name in OPENINGS:
        printed = thesis["table_6_3"][name.replace("-", "_").replace(" ", "_")]
        closed, opened = ([next(rows) for _ in PRESSURES_MMHG] for _ in range(2))
        for (p, bone, bone_left, dura, dura_left), c, o in zip(printed, closed, opened):
            lines.append([name, str(p), f"{bone}", f"{c['percent']:.2f}", f"{bone_left}",
                          f"{left_mmhg(p, c['percent']):.1f}", f"{dura}", f"{o['percent']:.2f}", f"{dura_left}",
                          f"{left_mmhg(p, o['percent']):.1f}", f"{float(o['smallest_det_f']):.2f}"])
    write_block("table 6.3", markdown(
        ["opening", "mmHg before", "bone removed: ΔV/V %, thesis", "ours", "mmHg left, thesis", "ours",
         "Dura opened: ΔV/V %, thesis", "ours", "mmHg left, thesis", "ours", "least det F"], lines))


def tables_6_1_and_6_2(study, thesis):
    temporal = opening_keys("lateral with temporal lobe")
    fixed = {**temporal, "step.tets.swellings": swellings(20)}
    first, second = thesis["table_6_1"]["rows"], thesis["table_6_2"]["rows"]
    elements = ["linear", "nodal_pressure", "quadratic"]
    cases = [{**fixed, "material.poisson": str(row[0]), "step.tets.element": element}
             for row in first for element in elements]
    rows = study.sweep("table_6_1", cases)
    lines = []
    for n, (poisson, percent, fall, left) in enumerate(first):
        ours = [row["percent"] for row in rows[3 * n:3 * n + 3]]
        lines.append([f"{poisson:.2f}", f"{percent:.2f}", *(f"{o:.2f}" for o in ours),
                      f"{100 * (ours[2] / percent - 1):+.1f} %", f"{left:.2f}",
                      f"{left_mmhg(20, ours[2], poisson):.2f}"])
    write_block("table 6.1", markdown(["ν", "ΔV/V %, thesis", *elements, "quadratic beside the thesis",
                                       "mmHg left, thesis", "quadratic"], lines))
    cases = [{**fixed, "material.stiffness": str(row[0] / 1000 if row[0] > 100 else row[0])} for row in second]
    rows = study.sweep("table_6_2", cases)
    lines = [[f"{e:g}", f"{percent:.2f}", f"{row['percent']:.2f}", f"{100 * (row['percent'] / percent - 1):+.1f} %",
              f"{left:.2f}", f"{left_mmhg(20, row['percent'], stiffness=e):.2f}"]
             for (e, percent, _, left), row in zip(second, rows)]
    write_block("table 6.2", markdown(["E, kPa", "ΔV/V %, thesis", "ours", "difference", "mmHg left, thesis", "ours"],
                                      lines))


def diagrams(study):
    """Figure 6.14: results over Poisson's ratio, and over Young's modulus."""
    temporal = opening_keys("lateral with temporal lobe")
    for name, key, values in (("poisson", "material.poisson", "0.2,0.25,0.3,0.35,0.4,0.43,0.45,0.47,0.48,0.49"),
                              ("stiffness", "material.stiffness", "3,4,5,6,7,8,9,10")):
        path = os.path.join(study.out, "figure_6_14_" + name)
        varied = [f"--vary={k}={v}" for k, v in temporal.items()]
        for y in ("pressure_kpa", "volume_ml"):
            study.run("sweep", SCENE, *varied, f"--vary=step.tets.swellings={swellings(20)}", f"--vary={key}={values}",
                      "--collect=pressure_kpa=mean_pressure_kpa", "--collect=volume_ml=volume_change_ml",
                      "-o", path + ".csv", "--plot", f"{path}_{y.split('_')[0]}.svg", "--x", key, "--y", y, "--force")


def shell(study):
    """The skull as a shell that only pushes; the brain stem is held, and the Dura goes all round."""
    around = {"step.tets.outside": "shell", "step.tets.shell_planes": "true", "step.fix": "[[80, 75, 0, 100, 96, 26]]"}
    whole, opened = sheets(sheet("opening"), sheet("outside")), sheets(sheet("outside"))
    cases = [{**opening_keys(name), **around, "step.tets.swellings": swellings(p), "step.tets.sheets": dura}
             for name in OPENINGS for dura in (whole, opened) for p in PRESSURES_MMHG]
    rows = iter(study.sweep("shell", cases))
    with open(os.path.join(study.out, "table_6_3.csv"), newline="") as file:
        held = iter([100 * float(row["volume_ml"]) / float(row["mesh_ml"]) for row in csv.DictReader(file)])
    text = lambda row: "no end" if row["percent"] is None else f"{row['percent']:.1f}"
    lines = []
    for name in OPENINGS:
        closed, opened = ([(next(rows), next(held)) for _ in PRESSURES_MMHG] for _ in range(2))
        for p, (c, hc), (o, ho) in zip(PRESSURES_MMHG, closed, opened):
            lines.append([name, str(p), f"{hc:.1f}", text(c), f"{ho:.1f}", text(o),
                          f"{float(o['smallest_det_f']):.2f}" if o["percent"] is not None else ""])
    write_block("shell", markdown(["opening", "mmHg before", "bone removed: ΔV/V %, held", "shell",
                                   "Dura opened: ΔV/V %, held", "shell", "least det F"], lines))


def finite(study):
    """The Dura opened, at finite strain."""
    cases = [{**opening_keys(name), "step.tets.swellings": swellings(p), "step.tets.strain": "finite"}
             for p in PRESSURES_MMHG for name in OPENINGS]
    rows = iter(study.sweep("finite", cases))
    text = lambda row: f"{row['percent']:.2f} ({float(row['smallest_det_f']):.2f})" if row["percent"] else "no end"
    write_block("finite", markdown(["mmHg before", *OPENINGS],
                                   [[str(p), *(text(next(rows)) for _ in OPENINGS)] for p in PRESSURES_MMHG]))


def brain_labels(study):
    labels = os.path.join(study.made, "brain_labels.nii.gz")
    if not os.path.exists(labels):
        subprocess.run([sys.executable, os.path.join(HERE, "brain_labels.py"), study.data,
                        os.path.join(study.made, "envelope.nii.gz"), labels], check=True)
    return labels


def parts(study):
    """Falx, tentorium, ventricles and uneven swelling, Dura opened, 20 mmHg."""
    labels = brain_labels(study)
    L = LABELS
    falx = [sheet("", [L["left"], L["right"]])]
    tentorium = [sheet("", [L[side], L["cerebellum"]]) for side in ("left", "right")]
    brain = [number for name, number in L.items() if name != "ventricles"]
    left = [L["left"], L["temporal_lobe"], L["sylvian_bank"]]
    fluid = lambda stiffness, poisson: (f"{{ {L['ventricles']} = {{ max_length = 1.1, min_length = 0.9, shear = 0.1, "
                                        f"stiffness = {stiffness}, poisson = {poisson} }} }}")
    variants = {
        "as in table 6.3": {},
        "Falx": {"step.tets.sheets": sheets(*falx)},
        "tentorium": {"step.tets.sheets": sheets(*tentorium)},
        "both": {"step.tets.sheets": sheets(*falx, *tentorium)},
        "ventricles keep their volume": {"material.label": fluid(0.6, 0.4999), "step.tets.swellings": swellings(20, brain)},
        "ventricles drained to 0 mmHg": {"material.label": fluid(0.006, 0.0), "step.tets.swellings": swellings(20, brain)},
        "temporal lobe cut free": {"step.cut": f"[{{ label = {L['temporal_lobe']}, from = {L['sylvian_bank']} }}]"},
        "only the left hemisphere swells": {"step.tets.swellings": swellings(20, left)},
        "the same with both": {"step.tets.sheets": sheets(*falx, *tentorium), "step.tets.swellings": swellings(20, left)},
    }
    cases = [{"labels.path": labels, "step.tets.labels": "true", "step.tets.swellings": swellings(20),
              **opening_keys(name), **changes} for changes in variants.values() for name in OPENINGS]
    rows = iter(study.sweep("parts", cases))
    lines = [[variant, *(f"{next(rows)['percent']:.2f}" for _ in OPENINGS)] for variant in variants]
    write_block("parts", markdown(["ΔV/V %, 20 mmHg, Dura opened", *OPENINGS], lines))


def pictures(study):
    """Figures 6.15 and 3.5."""
    brain_labels(study)
    for scene in (SCENE, os.path.join(HERE, "falx.toml")):
        study.run("run", scene, "-o", study.out, "--force")
    study.run("slice", os.path.join(study.out, "craniotomy.vdb"), "--at", "70,110,80", "--scale", "1.5",
              "--overlay", os.path.join(study.out, "craniotomy_pressure.nrrd"), "--overlay-range", "0,5.333",
              "-o", os.path.join(study.out, "craniotomy_pressure.png"), "--force")
    for name in ("craniotomy_rest.png", "craniotomy_swollen.png", "craniotomy_swollen_offset.png",
                 "craniotomy_slices.png", "craniotomy_pressure.png", "falx_rest.png", "falx_shifted.png",
                 "figure_6_14_poisson_pressure.svg", "figure_6_14_stiffness_volume.svg"):
        shutil.copy(os.path.join(study.out, name), os.path.join(ROOT, "docs/images", name))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--supple", default=os.path.join(ROOT, "build/release/bin/supple"))
    parser.add_argument("--data", default=os.path.join(ROOT, "build/data"))
    parser.add_argument("--anew", action="store_true")
    parser.add_argument("parts", nargs="*", choices=[*PARTS, []])
    options = parser.parse_args()
    study = Study(options)
    with open(os.path.join(HERE, "thesis_tables.toml"), "rb") as file:
        thesis = tomllib.load(file)
    wanted = options.parts or PARTS
    if "prepare" in wanted:
        study.prepare()
    if "tables" in wanted:
        table_6_3(study, thesis)
        tables_6_1_and_6_2(study, thesis)
        diagrams(study)
    if "finite" in wanted:
        finite(study)
    if "shell" in wanted:
        shell(study)
    if "parts" in wanted:
        parts(study)
    if "pictures" in wanted:
        pictures(study)


if __name__ == "__main__":
    main()
