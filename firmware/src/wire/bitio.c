#include "framing.h"

void pel_bitio_read(pel_bitio_t *io, const uint8_t *p, size_t n_bytes)
{
    io->writing = false;
    pel_bit_reader_init(&io->r, p, n_bytes);
}

void pel_bitio_write(pel_bitio_t *io, uint8_t *p, size_t n_bytes)
{
    io->writing = true;
    pel_bit_writer_init(&io->w, p, n_bytes);
}

bool pel_bitio_failed(const pel_bitio_t *io)
{
    return io->writing ? (io->w.overrun || io->w.out_of_range) : io->r.overrun;
}

void pel_io_u(pel_bitio_t *io, unsigned n_bits, uint32_t *v)
{
    if (io->writing) {
        pel_write_u(&io->w, n_bits, *v);
    } else {
        *v = (uint32_t)pel_read_u(&io->r, n_bits);
    }
}

void pel_io_fill(pel_bitio_t *io, unsigned n_bits, uint64_t v)
{
    if (io->writing) {
        pel_write_u(&io->w, n_bits, v);
    } else {
        pel_skip_bits(&io->r, n_bits);
    }
}

void pel_io_signed(pel_bitio_t *io, unsigned n_bits, double unit, double *v)
{
    if (io->writing) {
        pel_write_s(&io->w, n_bits, pel_round_i64(*v / unit));
    } else {
        *v = (double)pel_read_s(&io->r, n_bits) * unit;
    }
}
