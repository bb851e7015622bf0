"""Peer of `benches/training.rs`: for each line `BATCH ATTENTION` on stdin, samples per CPU second of training
one unit (18 inputs, T = 3, 128 + 128) in PyTorch on one thread."""

import sys
import time

import torch

torch.set_num_threads(1)
torch.manual_seed(0)
WIDTH, STEPS, INPUTS = 128, 3, 18


class Plain(torch.nn.Module):
    """Both layers as fused nn.LSTM: the fastest that PyTorch offers."""

    def __init__(self):
        super().__init__()
        self.encoder = torch.nn.LSTM(INPUTS, WIDTH, batch_first=True)
        self.reencoder = torch.nn.LSTM(WIDTH, WIDTH, batch_first=True)
        self.drop = torch.nn.Dropout(0.5)
        self.output = torch.nn.Linear(WIDTH, 1)

    def forward(self, x):
        h = self.drop(self.encoder(x)[0])
        return self.output(self.drop(self.reencoder(h)[0][:, -1]))


class Attention(torch.nn.Module):
    """Equations 21-24: the context depends on the re-encoder's last state, so that layer is a cell."""

    def __init__(self):
        super().__init__()
        self.encoder = torch.nn.LSTM(INPUTS, WIDTH, batch_first=True)
        self.query = torch.nn.Linear(WIDTH, WIDTH, bias=False)
        self.key = torch.nn.Linear(WIDTH, WIDTH)
        self.score = torch.nn.Linear(WIDTH, 1, bias=False)
        self.reencoder = torch.nn.LSTMCell(2 * WIDTH, WIDTH)
        self.drop = torch.nn.Dropout(0.5)
        self.output = torch.nn.Linear(WIDTH, 1)

    def forward(self, x):
        h = self.drop(self.encoder(x)[0])
        keys = self.key(h)
        s = c = x.new_zeros(x.shape[0], WIDTH)
        for t in range(STEPS):
            alpha = torch.softmax(self.score(torch.tanh(keys + self.query(s)[:, None])), dim=1)
            s, c = self.reencoder(torch.cat([h[:, t], (alpha * h).sum(1)], dim=1), (s, c))
        return self.output(self.drop(s))


networks = {}
for line in sys.stdin:
    batch, attention = map(int, line.split())
    if attention not in networks:
        network = Attention() if attention else Plain()
        networks[attention] = (network, torch.optim.Adam(network.parameters(), lr=1e-3))
    network, optimiser = networks[attention]
    x, y = torch.randn(batch, STEPS, INPUTS), torch.randn(batch, 1)
    for step in range(24):
        if step == 4:
            start = time.process_time()
        optimiser.zero_grad(set_to_none=True)
        torch.nn.functional.mse_loss(network(x), y).backward()
        optimiser.step()
    print(20 * batch / (time.process_time() - start), flush=True)
