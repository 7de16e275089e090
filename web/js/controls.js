import { identity } from './quaternion.js';

function stopsText(stops) {
  const sign = stops > 0 ? '+' : stops < 0 ? '−' : '';
  return `${sign}${Math.abs(stops).toFixed(1)} stops`;
}

/** The environment picker, the exposure slider and the buttons. Calls onChange({field: value}). */
export class Controls {
  #choices = document.getElementById('environment-choices');
  #exposure = document.getElementById('exposure');
  #exposureValue = document.getElementById('exposure-value');
  #onChange;

  constructor(onChange) {
    this.#onChange = onChange;
    this.#exposure.addEventListener('input', () => this.#setExposure(this.#exposure.valueAsNumber));
    this.#exposure.addEventListener('dblclick', () => this.#setExposure(0));
    document.getElementById('reset-exposure')
      .addEventListener('click', () => this.#setExposure(0));
    document.getElementById('reset-rotation')
      .addEventListener('click', () => onChange({ rotation: [...identity] }));
    const toggle = document.getElementById('toggle-overlay');
    const overlay = document.getElementById('overlay');
    toggle.addEventListener('click', () => {
      overlay.hidden = !overlay.hidden;
      toggle.setAttribute('aria-pressed', String(!overlay.hidden));
    });
    document.getElementById('controls').addEventListener('submit', (event) => event.preventDefault());
  }

  setEnvironments(names) {
    const current = [...this.#choices.querySelectorAll('input')].map((input) => input.value);
    if (JSON.stringify(current) === JSON.stringify(names)) return;
    this.#choices.replaceChildren(...names.map((name) => this.#choice(name)));
  }

  /** Shows a state that came from the server. */
  show(state) {
    for (const input of this.#choices.querySelectorAll('input')) {
      input.checked = input.value === state.environment;
    }
    this.#exposure.value = state.exposure;
    this.#exposureValue.textContent = stopsText(state.exposure);
  }

  #setExposure(stops) {
    this.#exposure.value = stops;
    this.#exposureValue.textContent = stopsText(stops);
    this.#onChange({ exposure: stops });
  }

  #choice(name) {
    const label = document.createElement('label');
    const input = document.createElement('input');
    input.type = 'radio';
    input.name = 'environment';
    input.value = name;
    input.addEventListener('change', () => this.#onChange({ environment: name }));
    const text = document.createElement('span');
    text.textContent = name.replaceAll(/[_-]+/g, ' ');
    label.append(input, text);
    return label;
  }
}
