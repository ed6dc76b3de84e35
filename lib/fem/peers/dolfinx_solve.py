"""Equilibrium of elastic hexahedra by DOLFINx 0.5, for `solver = "dolfinx"`.

solve.py FOLDER TOLERANCE ITERATIONS, in one process or several of MPI. The folder has nodes.f64
(n x 3, mm), corners.i32 (e x 8, corners 4 di + 2 dj + dk), shear.f64 and bulk.f64 (e, kPa), held.u8
(n, bit a: component a is held), held.f64 (n x 3, mm, where), forces.f64 (n x 3, mN, or empty), and
a file `pointwise` where elements have no mean dilatation. It gets `started` once forms are compiled,
and u.f64. Prints {"converged", "iterations", "peak_bytes", "assemble_s", "setup_s", "solve_s"};
exit code 3: DOLFINx is not installed.
"""
import ctypes
import json
import logging
import resource
import signal
import sys
import time
from pathlib import Path

try:
    import numpy as np
    import ufl
    from dolfinx import fem, mesh
    from dolfinx.fem import petsc
    from mpi4py import MPI
    from petsc4py import PETSc
except ImportError:
    sys.exit(3)

PR_SET_PDEATHSIG = 1
# Corners of DOLFINx's hexahedra, di + 2 dj + 4 dk, by ours.
CORNERS = [0, 4, 2, 6, 1, 5, 3, 7]


def compiled(domain, is_pointwise):
    """The space of displacements, the moduli of cells, and the form of the stiffness."""
    space = fem.VectorFunctionSpace(domain, ('Lagrange', 1))
    moduli = fem.FunctionSpace(domain, ('Discontinuous Lagrange', 0))
    shear, bulk = fem.Function(moduli), fem.Function(moduli)
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)

    def strain(w):
        return ufl.sym(ufl.grad(w))

    def volume(w):
        return ufl.tr(strain(w))

    full = ufl.dx(domain, metadata={'quadrature_degree': 3})
    mean = ufl.dx(domain, metadata={'quadrature_degree': 3 if is_pointwise else 1})
    stiffness = (2 * shear * ufl.inner(ufl.dev(strain(u)), ufl.dev(strain(v))) * full
                 + bulk * volume(u) * volume(v) * mean)
    return space, shear, bulk, fem.form(stiffness)


def rigid_motions(places, matrix):
    """PETSc's near null space: three translations and three turns, orthonormal."""
    basis = []
    for axis in range(6):
        motion = np.zeros_like(places)
        if axis < 3:
            motion[:, axis] = 1
        else:
            one, two = [n for n in range(3) if n != axis - 3]
            motion[:, one], motion[:, two] = -places[:, two], places[:, one]
        vector = matrix.createVecRight()
        vector.array[:] = motion.ravel()
        for other in basis:
            vector.axpy(-vector.dot(other), other)
        vector.normalize()
        basis.append(vector)
    return PETSc.NullSpace().create(vectors=basis)


def solver(matrix, tolerance, most):
    options = PETSc.Options()
    for name, value in {
            'ksp_type': 'cg', 'ksp_norm_type': 'unpreconditioned', 'ksp_rtol': tolerance,
            'ksp_max_it': most, 'ksp_converged_use_initial_residual_norm': '', 'pc_type': 'gamg',
            'mg_levels_ksp_type': 'chebyshev', 'mg_levels_pc_type': 'jacobi',
            'mg_levels_esteig_ksp_type': 'cg', 'mg_levels_ksp_chebyshev_esteig_steps': 20}.items():
        options[name] = value
    ksp = PETSc.KSP().create(matrix.comm)
    ksp.setFromOptions()
    ksp.setInitialGuessNonzero(True)
    ksp.setOperators(matrix)
    return ksp


def main():
    folder, tolerance, most = Path(sys.argv[1]), float(sys.argv[2]), int(sys.argv[3])
    comm = MPI.COMM_WORLD

    def read(name, kind, width=None):
        values = np.fromfile(folder / name, kind)
        return values if width is None else values.reshape(-1, width)

    def part(values):
        first, last = (rank * len(values) // comm.size for rank in (comm.rank, comm.rank + 1))
        return values[first:last]

    is_pointwise = (folder / 'pointwise').exists()
    compiled(mesh.create_unit_cube(comm, comm.size, 1, 1, mesh.CellType.hexahedron), is_pointwise)
    comm.barrier()
    if comm.rank == 0:
        (folder / 'started').touch()

    begin = time.perf_counter()
    nodes = read('nodes.f64', np.float64, 3)
    cells = read('corners.i32', np.int32, 8).astype(np.int64)[:, CORNERS]
    domain = mesh.create_mesh(comm, part(cells), part(nodes),
                              ufl.Mesh(ufl.VectorElement('Lagrange', 'hexahedron', 1)))
    space, shear, bulk, stiffness = compiled(domain, is_pointwise)
    cell_count = len(domain.topology.original_cell_index)
    places_of_cells = shear.function_space.dofmap.list.array[:cell_count]
    for values, name in ((shear, 'shear.f64'), (bulk, 'bulk.f64')):
        values.x.array[places_of_cells] = read(name, np.float64)[
            domain.topology.original_cell_index]
    # The node of the file that each node here is.
    index_map = space.dofmap.index_map
    node_of = np.empty(index_map.size_local + index_map.num_ghosts, np.int64)
    node_of[space.dofmap.list.array] = np.array(domain.geometry.input_global_indices)[
        domain.geometry.dofmap.array]
    own = node_of[:index_map.size_local]

    matrix = petsc.assemble_matrix(stiffness)
    matrix.assemble()
    u, forces = matrix.createVecRight(), matrix.createVecRight()
    held = (read('held.u8', np.uint8)[own, None] >> np.arange(3) & 1).astype(bool).ravel()
    u.array[:] = np.where(held, read('held.f64', np.float64, 3)[own].ravel(), 0)
    given = read('forces.f64', np.float64, 3)
    if len(given) > 0:
        forces.array[:] = given[own].ravel()
    first = matrix.getOwnershipRange()[0]
    matrix.zeroRowsColumns(first + np.flatnonzero(held).astype(np.int32),
                           diag=matrix.getDiagonal().sum() / matrix.size[0], x=u, b=forces)
    matrix.setNearNullSpace(
        rigid_motions(space.tabulate_dof_coordinates()[:index_map.size_local], matrix))
    assembled = time.perf_counter()
    ksp = solver(matrix, tolerance, most)
    ksp.setUp()
    ready = time.perf_counter()
    ksp.solve(forces, u)
    end = time.perf_counter()

    found = comm.gather((own, u.array.reshape(-1, 3)))
    peak_bytes = comm.reduce(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024)
    if comm.rank != 0:
        return
    for whose, values in found:
        nodes[whose] = values
    nodes.tofile(folder / 'u.f64')
    print(json.dumps({
        'converged': ksp.getConvergedReason() > 0, 'iterations': ksp.getIterationNumber(),
        'peak_bytes': peak_bytes, 'assemble_s': assembled - begin, 'setup_s': ready - assembled,
        'solve_s': end - ready}))


# Processes go with the one that started them.
ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
logging.disable(logging.INFO)
main()
