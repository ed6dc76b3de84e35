"""Module of 3D Slicer: a volume of the scene in the viewer of `supple`, in a browser or a window of
Slicer, and what is saved there as nodes of the scene.

Slicer finds it where this folder is one of *Edit, Application Settings, Modules, Additional module
paths*. `ViewerSession` knows nothing of Slicer.
"""
import gzip
import json
import os
import shutil
import signal
import struct
import subprocess
import tempfile
import threading

import qt
import slicer
from slicer.ScriptedLoadableModule import (ScriptedLoadableModule, ScriptedLoadableModuleLogic,
                                           ScriptedLoadableModuleWidget)

# Variables for Slicer's own libraries and Python, which are not for other programs.
OF_SLICER = ("LD_LIBRARY_PATH", "PYTHONHOME", "PYTHONPATH", "QT_PLUGIN_PATH")
# Intents of vectors in NIfTI: displacements, and vectors.
NIFTI_VECTORS = (1006, 1007)
START_SECONDS = 60
STOP_SECONDS = 10


class ViewerSession:
    """`supple view` on a volume file, and the files that are saved from its page.

    Raises RuntimeError, in one line, where the program is missing or ends before it has an address.
    """

    def __init__(self, program, volume, folder, material="", opens_browser=True):
        self.folder = folder
        self.seen = self._stamps()
        command = [program, "view", volume, "--folder", folder, "--json", "--grace", "0"]
        command += ["--material", material] if material else []
        command += [] if opens_browser else ["--no-browser"]
        environment = {name: value for name, value in os.environ.items() if name not in OF_SLICER}
        self.told = []
        try:
            self.process = subprocess.Popen(command, cwd=folder, env=environment, text=True,
                                            stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        except OSError as error:
            raise RuntimeError(f"{program}: {error.strerror}, expected the program supple") from None
        self.listener = threading.Thread(target=self._listen, daemon=True)
        self.listener.start()
        lines = []
        reader = threading.Thread(target=lambda: lines.append(self.process.stdout.readline()),
                                  daemon=True)
        reader.start()
        reader.join(START_SECONDS)
        try:
            self.address = json.loads(lines[0])["address"]
        except (IndexError, KeyError, ValueError):
            self.stop()
            last = self.told[-1] if self.told else "found no address, expected one"
            raise RuntimeError(last) from None

    def _listen(self):
        for line in self.process.stderr:
            self.told = self.told[-9:] + [line.strip()]

    def _stamps(self):
        """Sizes and times of the files of the folder; hidden ones are not finished."""
        stamps = {}
        for entry in os.scandir(self.folder):
            if entry.is_file() and not entry.name.startswith("."):
                status = entry.stat()
                stamps[entry.path] = (status.st_mtime_ns, status.st_size)
        return stamps

    def new_files(self):
        """Paths of what was saved or replaced since the last call, the oldest first."""
        now = self._stamps()
        fresh = [path for path, stamp in now.items() if self.seen.get(path) != stamp]
        self.seen = now
        return sorted(fresh, key=lambda path: now[path])

    def is_running(self):
        return self.process.poll() is None

    def stop(self):
        """Ends the program as Ctrl-C does: what it had not finished writing is gone."""
        if self.is_running():
            self.process.send_signal(signal.SIGINT)
        try:
            self.process.wait(STOP_SECONDS)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.listener.join(STOP_SECONDS)
        self.process.stdout.close()
        self.process.stderr.close()


def is_warp(path):
    """True for transforms, and images whose header says that they are displacements."""
    if path.endswith((".h5", ".tfm")):
        return True
    if path.endswith((".nii", ".nii.gz")):
        with (gzip.open if path.endswith(".gz") else open)(path, "rb") as file:
            head = file.read(70)
        return any(struct.unpack(f"{order}h", head[68:70])[0] in NIFTI_VECTORS for order in "<>")
    if not path.endswith((".nrrd", ".nhdr", ".mha", ".mhd")):
        return False
    with open(path, "rb") as file:
        head = file.read(4096)
    return b"displacement" in head or b"ElementNumberOfChannels = 3" in head


def loader_of(path):
    """The loader of slicer.util for a file; None: nothing that Slicer shows, such as a state."""
    if is_warp(path):
        return "loadTransform"
    endings = {(".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".nii.gz"): "loadVolume",
               (".vtk", ".ply", ".stl", ".obj"): "loadModel",
               (".mrk.json", ".fcsv"): "loadMarkups"}
    return next((loader for names, loader in endings.items() if path.endswith(names)), None)


class SuppleView(ScriptedLoadableModule):
    def __init__(self, parent):
        super().__init__(parent)
        parent.title = "Supple Viewer"
        parent.categories = ["Supple"]
        parent.contributors = ["Supple developers"]
        parent.helpText = ("Grab tissue of a volume and drag it, in the viewer of supple; save warps "
                           "and volumes there, and bring them back.")
        parent.acknowledgementText = "Apache License 2.0"


class SuppleViewLogic(ScriptedLoadableModuleLogic):
    """A session at a time, in a folder of its own that goes with it."""

    def __init__(self):
        super().__init__()
        self.session = None
        self.folder = None
        self.volume = None

    def start(self, volume_node, program="supple", material="", opens_browser=True):
        """Opens the volume of a node; returns the address of the page. Raises RuntimeError."""
        self.stop()
        self.folder = tempfile.mkdtemp(prefix="supple-slicer-")
        path = os.path.join(self.folder, "volume.nrrd")
        try:
            if not slicer.util.saveNode(volume_node, path):
                raise RuntimeError(f"{path}: the volume was not written, expected a volume node")
            self.session = ViewerSession(program, path, self.folder, material, opens_browser)
        except RuntimeError:
            self.stop()
            raise
        self.volume = volume_node
        return self.session.address

    def bring(self, moves_volume=False):
        """Loads what was saved since the last call; returns the nodes. `moves_volume`: the volume is
        seen through the last warp."""
        nodes = []
        for path in self.session.new_files() if self.session else []:
            loader = loader_of(path)
            if loader is None:
                continue
            node = getattr(slicer.util, loader)(path)
            nodes.append(node)
            if moves_volume and loader == "loadTransform":
                self.volume.SetAndObserveTransformNodeID(node.GetID())
        return nodes

    def stop(self):
        """Ends the session; what it saved and was not brought is gone."""
        if self.session:
            self.session.stop()
            self.session = None
        if self.folder:
            shutil.rmtree(self.folder, ignore_errors=True)
            self.folder = None


class SuppleViewWidget(ScriptedLoadableModuleWidget):
    def setup(self):
        super().setup()
        self.logic = SuppleViewLogic()
        self.window = None
        form = qt.QFormLayout()
        self.layout.addLayout(form)
        self.volume = slicer.qMRMLNodeComboBox()
        self.volume.nodeTypes = ["vtkMRMLScalarVolumeNode"]
        self.volume.addEnabled = self.volume.removeEnabled = False
        self.volume.setMRMLScene(slicer.mrmlScene)
        form.addRow("Volume", self.volume)
        self.material = qt.QLineEdit()
        self.material.setPlaceholderText("the preset that fits the densities")
        form.addRow("Material", self.material)
        self.program = qt.QLineEdit(qt.QSettings().value("Supple/Program") or "supple")
        form.addRow("Program", self.program)
        self.moves = qt.QCheckBox("Show the volume through a warp")
        form.addRow(self.moves)
        for text, act in (("Start", self.start), ("Bring what was saved", self.bring),
                          ("Stop", self.logic.stop)):
            button = qt.QPushButton(text)
            button.connect("clicked()", act)
            form.addRow(button)
        self.layout.addStretch(1)

    def start(self):
        qt.QSettings().setValue("Supple/Program", self.program.text)
        has_window = hasattr(slicer, "qSlicerWebWidget")
        try:
            address = self.logic.start(self.volume.currentNode(), self.program.text,
                                       self.material.text, opens_browser=not has_window)
        except RuntimeError as error:
            slicer.util.errorDisplay(str(error))
            return
        if has_window:
            self.window = slicer.qSlicerWebWidget()
            self.window.url = address
            self.window.show()

    def bring(self):
        if not self.logic.bring(self.moves.checked):
            slicer.util.infoDisplay("Nothing was saved since the last time: use Save in the page.")

    def cleanup(self):
        self.logic.stop()
