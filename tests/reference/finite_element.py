# SPDX-License-Identifier: GPL-3.0-or-later
"""A hyperelastic body in DOLFINx: UFL derives forces and stiffness from the energy alone."""

import dolfinx
import numpy as np
import scipy.sparse
import ufl
from dolfinx import fem
from mpi4py import MPI
from petsc4py import PETSc


def lame(young_modulus_pa, poisson_ratio):
    """Lame's mu and lambda of linear elasticity (Pa)."""
    mu = young_modulus_pa / (2 * (1 + poisson_ratio))
    return mu, 2 * mu * poisson_ratio / (1 - 2 * poisson_ratio)


def energy_density(model, f, mu, lam):
    """Psi(F) in Pa, see README.md."""
    if model == "stvk":
        strain = (f.T * f - ufl.Identity(3)) / 2
        return mu * ufl.inner(strain, strain) + lam / 2 * ufl.tr(strain) ** 2
    if model == "neohookean":  # Smith et al. 2018, eq. 14, with the Lame reparametrisation
        m = 4 / 3 * mu
        l = lam + 5 / 6 * mu
        alpha = 1 + m / l - m / (4 * l)
        i_c = ufl.inner(f, f)
        j = ufl.det(f)
        return m / 2 * (i_c - 3) + l / 2 * (j - alpha) ** 2 - m / 2 * ufl.ln(i_c + 1)
    raise ValueError(model)


class Body:
    """Nodal forces and stiffness of a mesh of tetrahedra; nodes are in DOLFINx's order."""

    def __init__(self, position, tetrahedron, model, young_modulus_pa, poisson_ratio,
                 density_kg_m3=0.0, gravity_m_s2=(0.0, 0.0, 0.0), degree=1):
        shape = ufl.Mesh(ufl.VectorElement("Lagrange", "tetrahedron", 1))
        mesh = dolfinx.mesh.create_mesh(MPI.COMM_SELF, tetrahedron.astype(np.int64), position,
                                        shape)
        space = fem.VectorFunctionSpace(mesh, ("Lagrange", degree))
        self.u = fem.Function(space)
        self.position = space.tabulate_dof_coordinates()  # m, (nodes x 3)
        self.node_count = len(self.position)
        if degree == 1:
            self.node_of_vertex = self._node_of_vertex(mesh, space, len(position))
        # F is constant in a linear element; four is ample for a quadratic one.
        dx = ufl.dx(metadata={"quadrature_degree": 1 if degree == 1 else 4})
        mu, lam = (fem.Constant(mesh, c) for c in lame(young_modulus_pa, poisson_ratio))
        f = ufl.Identity(3) + ufl.grad(self.u)
        self._full_weight = density_kg_m3 * np.array(gravity_m_s2)
        self._weight = fem.Constant(mesh, self._full_weight)  # N/m^3
        energy = energy_density(model, f, mu, lam) * dx - ufl.dot(self._weight, self.u) * ufl.dx
        force = ufl.derivative(energy, self.u)
        self._energy = fem.form(energy)
        self._gradient = fem.form(force)
        self._hessian = fem.form(ufl.derivative(force, self.u))
        self._matrix = fem.petsc.create_matrix(self._hessian)

    @staticmethod
    def _node_of_vertex(mesh, space, vertex_count):
        node = np.full(vertex_count, -1)
        vertex = np.asarray(mesh.geometry.input_global_indices)
        for cell in range(mesh.topology.index_map(3).size_local):
            node[vertex[mesh.geometry.dofmap.links(cell)]] = space.dofmap.cell_dofs(cell)
        assert (node >= 0).all()
        return node

    def set_load(self, fraction):
        """Scales the weight."""
        self._weight.value[:] = fraction * self._full_weight

    def energy(self, u):
        """Potential energy (J), weight included, at displacements u (m, (3 nodes))."""
        self.u.x.array[:] = u
        return fem.assemble_scalar(self._energy)

    def gradient(self, u):
        """Its gradient (N, (3 nodes)): what holds the body there, as a force on the body."""
        self.u.x.array[:] = u
        vector = fem.petsc.assemble_vector(self._gradient)
        out = vector.array.copy()
        vector.destroy()
        return out

    def hessian(self, u):
        """Its Hessian (N/m) as a sparse matrix."""
        self.u.x.array[:] = u
        self._matrix.zeroEntries()
        fem.petsc.assemble_matrix(self._matrix, self._hessian)
        self._matrix.assemble()
        rows, columns, values = self._matrix.getValuesCSR()
        return scipy.sparse.csr_matrix((values, columns, rows), shape=2 * (len(u),))


class Factor:
    """L D L^T of a symmetric sparse matrix by MUMPS; counts its negative eigenvalues."""

    def __init__(self, matrix):
        csr = scipy.sparse.csr_matrix(matrix)
        csr.sort_indices()
        self._a = PETSc.Mat().createAIJ(csr.shape, csr=(csr.indptr, csr.indices, csr.data),
                                        comm=PETSc.COMM_SELF)
        self._a.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        self._ksp = PETSc.KSP().create(PETSc.COMM_SELF)
        self._ksp.setOperators(self._a)
        self._ksp.setType("preonly")
        pc = self._ksp.getPC()
        pc.setType("cholesky")
        pc.setFactorSolverType("mumps")
        pc.setFactorSetUpSolverType()
        pc.getFactorMatrix().setMumpsIcntl(24, 1)
        pc.getFactorMatrix().setMumpsIcntl(14, 100)
        self._ksp.setUp()
        self.negative_count = pc.getFactorMatrix().getMumpsInfog(12)

    def solve(self, b):
        right, left = self._a.createVecs()
        right.array[:] = b
        self._ksp.solve(right, left)
        out = left.array.copy()
        for thing in (right, left, self._ksp, self._a):
            thing.destroy()
        return out
